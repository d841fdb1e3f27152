#include "stages/read/columns.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace seampath {
namespace {

constexpr std::size_t kBlockRecords = 1 << 16;

static_assert(std::endian::native == std::endian::little, "the readers are written for little-endian machines");

template <class T>
T load_as(const char* at, bool swap) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), at, sizeof(T));
    if (swap) {
        std::reverse(bytes.begin(), bytes.end());
    }
    return std::bit_cast<T>(bytes);
}

Eigen::Vector3d load_vector(const std::array<Column, 3>& columns, std::size_t i) {
    const auto at = [&](const Column& c) { return load(c.first + i * c.stride, c.type, c.swap); };
    return {at(columns[0]), at(columns[1]), at(columns[2])};
}

Eigen::Vector3d sampled_origin(const std::array<Column, 3>& position, std::size_t count) {
    constexpr std::size_t kSamples = 1024;
    std::vector<Eigen::Vector3d> samples;
    const std::size_t step = std::max<std::size_t>(1, count / kSamples);
    for (std::size_t i = 0; i < count; i += step) {
        samples.push_back(load_vector(position, i));
    }
    return choose_origin(samples);
}

void decode_plain(const std::array<Column, 3>& position, std::size_t begin, std::size_t end, Slots& slots) {
    const std::size_t stride = position[0].stride;
    const std::ptrdiff_t to_y = position[1].first - position[0].first;
    const std::ptrdiff_t to_z = position[2].first - position[0].first;
    const char* at = position[0].first + begin * stride;
    for (std::size_t i = begin; i < end; ++i, at += stride) {
        slots.add_plain(
            {load_as<float>(at, false), load_as<float>(at + to_y, false), load_as<float>(at + to_z, false)});
    }
}

}  // namespace

std::size_t size_of(Scalar type) {
    constexpr std::array<std::size_t, 10> kSizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return kSizes[static_cast<std::size_t>(type)];
}

double load(const char* at, Scalar type, bool swap) {
    switch (type) {
        case Scalar::i8:
            return load_as<std::int8_t>(at, swap);
        case Scalar::u8:
            return load_as<std::uint8_t>(at, swap);
        case Scalar::i16:
            return load_as<std::int16_t>(at, swap);
        case Scalar::u16:
            return load_as<std::uint16_t>(at, swap);
        case Scalar::i32:
            return load_as<std::int32_t>(at, swap);
        case Scalar::u32:
            return load_as<std::uint32_t>(at, swap);
        case Scalar::i64:
            return static_cast<double>(load_as<std::int64_t>(at, swap));
        case Scalar::u64:
            return static_cast<double>(load_as<std::uint64_t>(at, swap));
        case Scalar::f32:
            return static_cast<double>(load_as<float>(at, swap));
        case Scalar::f64:
            break;
    }
    return load_as<double>(at, swap);
}

void decode_columns(Cloud& cloud, const std::array<Column, 3>& position,
                    const std::optional<std::array<Column, 3>>& normal, std::size_t count, bool record_numbers) {
    const auto is_float = [](const Column& c) { return c.type == Scalar::f32; };
    const auto is_plain = [&](const Column& c) { return is_float(c) && !c.swap && c.stride == position[0].stride; };
    const bool floats = std::all_of(position.begin(), position.end(), is_float);
    const bool plain = !normal && !record_numbers && std::all_of(position.begin(), position.end(), is_plain);
    cloud.records = count;
    // Floats have lost their digits already: origin 0 keeps them exactly as they are.
    cloud.origin = floats ? Eigen::Vector3d(0, 0, 0) : sampled_origin(position, count);
    std::vector<std::size_t> first;
    for (std::size_t begin = 0; begin < count; begin += kBlockRecords) {
        first.push_back(begin);
    }
    first.push_back(count);
    fill_cloud(cloud, first, {normal.has_value(), record_numbers}, [&](std::size_t block, Slots& slots) {
        if (plain) {
            decode_plain(position, first[block], first[block + 1], slots);
            return;
        }
        for (std::size_t i = first[block]; i < first[block + 1]; ++i) {
            slots.add(load_vector(position, i), normal ? load_vector(*normal, i) : Eigen::Vector3d(0, 0, 0), i);
        }
    });
    cloud.dropped = count - cloud.points.size();
}

}  // namespace seampath
