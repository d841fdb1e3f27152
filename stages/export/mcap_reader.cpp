#include <cstring>
#include <map>
#include <utility>

#include "stages/error.hpp"
#include "stages/export/ros.hpp"

/// Reads MCAP from its specification: every record once through, lengths held to what is there.
namespace seampath::exporting {
namespace mcap_reader {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

class Bytes {
public:
    Bytes(std::string_view bytes, std::string file, std::size_t offset)
        : left_(bytes), file_(std::move(file)), at_(offset) {}

    bool done() const { return left_.empty(); }
    std::size_t at() const { return at_; }

    std::string_view take(std::uint64_t size) {
        require(size <= left_.size(), "as many bytes as are announced");
        const std::string_view taken = left_.substr(0, size);
        left_.remove_prefix(size);
        at_ += size;
        return taken;
    }
    template <class Number>
    Number number() {
        Number value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    std::string_view text() { return take(number<std::uint32_t>()); }
    Bytes part(std::uint64_t size) {
        const std::size_t start = at_;
        return {take(size), file_, start};
    }
    void require(bool holds, const char* needed) const {
        if (!holds) {
            throw InternalError("export: " + file_ + ": byte " + std::to_string(at_) + ": " + needed + " was needed");
        }
    }

private:
    std::string_view left_;
    std::string file_;
    std::size_t at_;
};

class Reader {
public:
    Reader(std::string_view bytes, const std::string& name) : file_(bytes, name, 0) {
        file_.require(file_.take(kMagic.size()) == kMagic, "the magic bytes");
        while (!footer_) {
            record(file_);
        }
        file_.require(file_.take(kMagic.size()) == kMagic && file_.done(), "the magic bytes at the end");
        file_.require(header_ && data_end_, "a header and an end of data");
        file_.require(counted_ == bag.messages.size(), "as many messages as the statistics say");
    }
    Bag bag;

private:
    struct Schema {
        std::string type, text;
    };

    void record(Bytes& from) {
        const std::size_t start = from.at();
        const auto opcode = from.number<std::uint8_t>();
        Bytes content = from.part(from.number<std::uint64_t>());
        switch (opcode) {
            case 0x01:
                content.require(!header_ && content.text() == "ros2", "one header, of profile ros2");
                content.text();
                header_ = true;
                break;
            case 0x02:
                content.require(content.number<std::uint64_t>() == summary_, "the place of the summary");
                content.take(12);
                footer_ = true;
                break;
            case 0x03:
                schema(content);
                break;
            case 0x04:
                channel(content);
                break;
            case 0x05:
                message(content, start);
                break;
            case 0x06:
                chunk(content);
                break;
            case 0x07:
                message_index(content);
                break;
            case 0x08:
                content.take(8 + 8 + 8 + 8);
                content.text();
                content.take(8);
                content.require(content.text().empty(), "no compression");
                content.take(8 + 8);
                break;
            case 0x0B:
                counted_ = content.number<std::uint64_t>();
                content.take(2 + 4 + 4 + 4 + 4 + 8 + 8);
                content.text();
                break;
            case 0x0E:
                content.take(1 + 8 + 8);
                break;
            case 0x0F:
                content.take(4);
                data_end_ = true;
                summary_ = from.at();
                break;
            default:
                content.require(false, "a known record");
        }
        content.require(content.done(), "no bytes behind a record's content");
    }

    void schema(Bytes& content) {
        const auto id = content.number<std::uint16_t>();
        Schema found{std::string(content.text()), ""};
        content.require(content.text() == "ros2msg", "the encoding ros2msg");
        found.text = content.text();
        const auto [known, first] = schemas_.emplace(id, found);
        content.require(id != 0 && known->second.type == found.type && known->second.text == found.text,
                        "the same schema as before");
        content.require(first != data_end_, "each schema in data and again in the summary");
    }

    void channel(Bytes& content) {
        const auto id = content.number<std::uint16_t>();
        const auto schema = schemas_.find(content.number<std::uint16_t>());
        content.require(schema != schemas_.end(), "a schema before its channel");
        const std::string name(content.text());
        content.require(content.text() == "cdr" && content.text().empty(), "the encoding cdr");
        if (data_end_) {
            content.require(id < bag.topics.size() && bag.topics[id].name == name, "the same channel as before");
            return;
        }
        content.require(id == bag.topics.size(), "channels that count from 0");
        bag.topics.push_back({name, schema->second.type, schema->second.text});
    }

    void message(Bytes& content, std::size_t start) {
        BagMessage message;
        message.channel = content.number<std::uint16_t>();
        content.require(in_chunk_ && message.channel < bag.topics.size(), "a channel before its messages");
        content.number<std::uint32_t>();
        message.time_ns = content.number<std::uint64_t>();
        content.require(content.number<std::uint64_t>() == message.time_ns, "the same time of log and publication");
        content.require(bag.messages.empty() || message.time_ns >= bag.messages.back().time_ns, "times that go on");
        while (!content.done()) {
            message.data += content.take(1);
        }
        places_[{message.channel, message.time_ns}].push_back(start - chunk_start_);
        bag.messages.push_back(std::move(message));
    }

    void chunk(Bytes& content) {
        content.require(!in_chunk_, "one chunk");
        const auto first = content.number<std::uint64_t>(), last = content.number<std::uint64_t>();
        const auto size = content.number<std::uint64_t>();
        content.take(4);
        content.require(content.text().empty() && content.number<std::uint64_t>() == size, "no compression");
        chunk_start_ = content.at();
        in_chunk_ = true;
        Bytes records = content.part(size);
        while (!records.done()) {
            record(records);
        }
        content.require(
            bag.messages.empty() || (bag.messages.front().time_ns == first && bag.messages.back().time_ns == last),
            "the times of the first and last message");
    }

    void message_index(Bytes& content) {
        const auto channel = content.number<std::uint16_t>();
        Bytes entries = content.part(content.number<std::uint32_t>());
        while (!entries.done()) {
            const auto time = entries.number<std::uint64_t>(), offset = entries.number<std::uint64_t>();
            const auto found = places_.find({channel, time});
            bool there = false;
            for (const std::size_t place : found == places_.end() ? std::vector<std::size_t>() : found->second) {
                there = there || place == offset;
            }
            entries.require(there, "a message where the index says");
        }
    }

    Bytes file_;
    std::map<std::uint16_t, Schema> schemas_;
    std::map<std::pair<std::uint16_t, std::uint64_t>, std::vector<std::size_t>> places_;
    std::uint64_t summary_ = 0, counted_ = 0;
    std::size_t chunk_start_ = 0;
    bool header_ = false, in_chunk_ = false, data_end_ = false, footer_ = false;
};

}  // namespace mcap_reader

Bag read_mcap(std::string_view bytes, const std::string& file_name) {
    return mcap_reader::Reader(bytes, file_name).bag;
}

}  // namespace seampath::exporting
