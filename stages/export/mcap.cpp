#include <bit>
#include <type_traits>

#include "stages/export/ros.hpp"

/// MCAP as mcap.dev/spec has it: records of an opcode, a length and a content; numbers little-endian; CRC 0 is none.
namespace seampath::exporting {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

template <class Number>
std::string bytes_of(Number number) {
    static_assert(std::is_integral_v<Number>);
    return {reinterpret_cast<const char*>(&number), sizeof number};
}

std::string text_of(std::string_view text) {
    return bytes_of(static_cast<std::uint32_t>(text.size())) + std::string(text);
}

std::string record(std::uint8_t opcode, const std::string& content) {
    return bytes_of(opcode) + bytes_of(static_cast<std::uint64_t>(content.size())) + content;
}

std::string schema_records(const std::vector<BagTopic>& topics) {
    std::string text;
    for (std::size_t i = 0; i < topics.size(); ++i) {
        text += record(0x03, bytes_of(static_cast<std::uint16_t>(i + 1)) + text_of(topics[i].type) +
                                 text_of("ros2msg") + text_of(topics[i].schema));
    }
    return text;
}

std::string channel_records(const std::vector<BagTopic>& topics) {
    std::string text;
    for (std::size_t i = 0; i < topics.size(); ++i) {
        text += record(0x04, bytes_of(static_cast<std::uint16_t>(i)) + bytes_of(static_cast<std::uint16_t>(i + 1)) +
                                 text_of(topics[i].name) + text_of("cdr") + bytes_of(std::uint32_t{0}));
    }
    return text;
}

}  // namespace

std::string write_mcap(const std::vector<BagTopic>& topics, const std::vector<BagMessage>& messages) {
    const std::string schemas = schema_records(topics), channels = channel_records(topics);
    std::string chunk = schemas + channels;
    std::vector<std::string> index(topics.size());  // times and places of each channel's messages
    std::vector<std::uint64_t> count(topics.size(), 0);
    for (const BagMessage& message : messages) {
        index[message.channel] += bytes_of(message.time_ns) + bytes_of(static_cast<std::uint64_t>(chunk.size()));
        const auto sequence = static_cast<std::uint32_t>(count[message.channel]++);
        chunk += record(0x05, bytes_of(message.channel) + bytes_of(sequence) + bytes_of(message.time_ns) +
                                  bytes_of(message.time_ns) + message.data);
    }
    const std::string span = bytes_of(messages.empty() ? 0 : messages.front().time_ns) +
                             bytes_of(messages.empty() ? 0 : messages.back().time_ns);
    const std::string size = bytes_of(static_cast<std::uint64_t>(chunk.size()));

    std::string file(kMagic);
    file += record(0x01, text_of("ros2") + text_of("seampath"));
    const auto chunk_start = static_cast<std::uint64_t>(file.size());
    file += record(0x06, span + size + bytes_of(std::uint32_t{0}) + text_of("") + size + chunk);
    const auto chunk_length = static_cast<std::uint64_t>(file.size()) - chunk_start;
    std::string offsets, counts;
    const std::size_t index_start = file.size();
    for (std::size_t i = 0; i < topics.size(); ++i) {
        const auto id = static_cast<std::uint16_t>(i);
        offsets += bytes_of(id) + bytes_of(static_cast<std::uint64_t>(file.size()));
        counts += bytes_of(id) + bytes_of(count[i]);
        file += record(0x07, bytes_of(id) + text_of(index[i]));
    }
    const auto index_length = static_cast<std::uint64_t>(file.size() - index_start);
    file += record(0x0F, bytes_of(std::uint32_t{0}));

    const auto summary_start = static_cast<std::uint64_t>(file.size());
    const std::string chunk_index =
        record(0x08, span + bytes_of(chunk_start) + bytes_of(chunk_length) + text_of(offsets) + bytes_of(index_length) +
                         text_of("") + size + size);
    const std::string statistics =
        record(0x0B, bytes_of(static_cast<std::uint64_t>(messages.size())) +
                         bytes_of(static_cast<std::uint16_t>(topics.size())) +
                         bytes_of(static_cast<std::uint32_t>(topics.size())) + bytes_of(std::uint32_t{0}) +
                         bytes_of(std::uint32_t{0}) + bytes_of(std::uint32_t{1}) + span + text_of(counts));
    std::string groups;
    const auto group = [&](std::uint8_t opcode, const std::string& records) {
        groups += record(0x0E, bytes_of(opcode) + bytes_of(static_cast<std::uint64_t>(file.size())) +
                                   bytes_of(static_cast<std::uint64_t>(records.size())));
        file += records;
    };
    group(0x03, schemas);
    group(0x04, channels);
    group(0x0B, statistics);
    group(0x08, chunk_index);
    const auto groups_start = static_cast<std::uint64_t>(file.size());
    file += groups;
    file += record(0x02, bytes_of(summary_start) + bytes_of(groups_start) + bytes_of(std::uint32_t{0}));
    return file + std::string(kMagic);
}

}  // namespace seampath::exporting
