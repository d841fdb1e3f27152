#include "stages/read/rows.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace seampath {
namespace {

constexpr std::size_t kRowBlockBytes = 1 << 18;
constexpr std::size_t kSamples = 1024;

/// Why a row could not be read; empty when it could.
using Complaint = std::string;

Complaint read_item(std::string_view& line, const RowItem& item, char separator, RowNumbers& numbers) {
    const std::string_view field = next_field(line, separator);
    if (item.slot >= 0) {
        const auto value = parse_number(field);
        if (!value) {
            return in_quotes(field) + " is not a number";
        }
        numbers[static_cast<std::size_t>(item.slot)] = *value;
    } else if (item.list) {
        const auto length = parse_integer<std::uint32_t>(field);
        if (!length) {
            return in_quotes(field) + " is not the length of a list";
        }
        for (std::uint32_t i = 0; i < *length; ++i) {
            if (next_field(line, separator).empty()) {
                return "the line ends within a list of " + std::to_string(*length);
            }
        }
    }
    return {};
}

Complaint read_row(const std::string_view row, const RowLayout& layout, RowNumbers& numbers) {
    std::string_view line = row;
    for (std::size_t i = 0; i < layout.items.size(); ++i) {
        // A separator at the very end has an empty field behind it.
        const bool last_is_empty =
            layout.separator != ' ' && i + 1 == layout.items.size() && row.ends_with(layout.separator);
        if (line.empty() && !last_is_empty) {
            return "the line has " + std::to_string(i) + " of the " + std::to_string(layout.items.size()) +
                   " values expected";
        }
        if (Complaint complaint = read_item(line, layout.items[i], layout.separator, numbers); !complaint.empty()) {
            return complaint;
        }
    }
    if (!line.empty()) {
        return "the line has more than the " + std::to_string(layout.items.size()) + " values expected";
    }
    return {};
}

/// Number of the first row of each block, and the count of all.
std::vector<std::size_t> row_numbers(const Rows& rows) {
    std::vector<std::size_t> first{0};
    for (const RowBlock& block : rows.blocks) {
        first.push_back(first.back() + block.rows);
    }
    return first;
}

}  // namespace

bool RowLayout::has_normals() const {
    return std::any_of(items.begin(), items.end(), [](const RowItem& item) { return item.slot >= 3; });
}

std::string_view next_field(std::string_view& line, char separator) {
    if (separator == ' ') {
        return next_token(line);
    }
    const std::size_t end = line.find(separator);
    const std::string_view field = trimmed(line.substr(0, end));
    line.remove_prefix(end == std::string_view::npos ? line.size() : end + 1);
    return field;
}

std::string_view next_row(std::string_view bytes, std::size_t& offset) {
    while (offset < bytes.size()) {
        const std::string_view line = trimmed(next_line(bytes, offset));
        if (!line.empty() && line.front() != '#' && !line.starts_with("//")) {
            return line;
        }
    }
    return {};
}

Rows find_rows(const Source& source, std::size_t offset) {
    Rows rows;
    const std::string_view bytes = source.bytes;
    while (offset < bytes.size()) {
        const std::size_t newline = bytes.find('\n', std::min(offset + kRowBlockBytes, bytes.size()) - 1);
        const std::size_t end = newline == std::string_view::npos ? bytes.size() : newline + 1;
        rows.blocks.push_back({offset, end, 0});
        offset = end;
    }
    for_each_block(rows.blocks.size(), [&](std::size_t b) {
        RowBlock& block = rows.blocks[b];
        const std::string_view lines = bytes.substr(0, block.end);
        std::size_t at = block.begin;
        while (!next_row(lines, at).empty()) {
            ++block.rows;
        }
    });
    for (const RowBlock& block : rows.blocks) {
        rows.count += block.rows;
    }
    return rows;
}

std::vector<RowNumbers> sample_rows(const Source& source, const Rows& rows, std::size_t first, std::size_t count,
                                    const RowLayout& layout) {
    const auto number = row_numbers(rows);
    const std::size_t blocks = rows.blocks.size();
    const std::size_t step = std::max<std::size_t>(1, blocks / kSamples);
    const std::size_t per_block = std::max<std::size_t>(1, kSamples / std::max<std::size_t>(1, blocks));
    std::vector<RowNumbers> samples;
    for (std::size_t b = 0; b < blocks; b += step) {
        const std::string_view lines = source.bytes.substr(0, rows.blocks[b].end);
        std::size_t at = rows.blocks[b].begin;
        std::size_t taken = 0;
        for (std::size_t row = number[b]; row < number[b + 1] && row < first + count && taken < per_block; ++row) {
            const std::string_view line = next_row(lines, at);
            RowNumbers numbers{};
            if (row >= first && read_row(line, layout, numbers).empty()) {
                samples.push_back(numbers);
                ++taken;
            }
        }
    }
    return samples;
}

void decode_rows(Cloud& cloud, const Source& source, const Rows& rows, std::size_t first, std::size_t count,
                 const RowLayout& layout, bool record_numbers) {
    std::vector<Eigen::Vector3d> samples;
    for (const RowNumbers& s : sample_rows(source, rows, first, count, layout)) {
        samples.emplace_back(s[0], s[1], s[2]);
    }
    cloud.origin = choose_origin(samples);
    cloud.records = count;
    const auto number = row_numbers(rows);
    std::vector<std::size_t> record;  // of each block's first row
    for (const std::size_t row : number) {
        record.push_back(std::clamp(row, first, first + count) - first);
    }
    fill_cloud(cloud, record, {layout.has_normals(), record_numbers}, [&](std::size_t b, Slots& slots) {
        const std::string_view lines = source.bytes.substr(0, rows.blocks[b].end);
        std::size_t at = rows.blocks[b].begin;
        for (std::size_t row = number[b]; row < std::min(number[b + 1], first + count); ++row) {
            const std::string_view line = next_row(lines, at);
            if (row < first) {
                continue;
            }
            RowNumbers n{};
            if (const Complaint complaint = read_row(line, layout, n); !complaint.empty()) {
                fail_at_line(source, static_cast<std::size_t>(line.data() - source.bytes.data()),
                             complaint + "; repair or remove this line");
            }
            slots.add({n[0], n[1], n[2]}, {n[3], n[4], n[5]}, row - first);
        }
    });
    cloud.dropped = count - cloud.points.size();
}

}  // namespace seampath
