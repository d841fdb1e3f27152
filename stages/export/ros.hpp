#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Private to the export stage: bags of ROS 2 messages. Writer and reader share these names and nothing else.
namespace seampath::exporting {

/// One message of a bag.
struct BagMessage {
    std::uint16_t channel = 0;  ///< index of the topic
    std::uint64_t time_ns = 0;
    std::string data;  ///< CDR, little-endian, with its encapsulation header
};

struct BagTopic {
    std::string name;
    std::string type;    ///< e.g. "std_msgs/msg/Bool"
    std::string schema;  ///< its definition with those of all types in it, as ros2msg has them
};

/// An MCAP file (profile ros2) with one uncompressed chunk, its index and statistics, so that players may seek.
/// Messages are in the order of their times.
std::string write_mcap(const std::vector<BagTopic>& topics, const std::vector<BagMessage>& messages);

struct Bag {
    std::vector<BagTopic> topics;
    std::vector<BagMessage> messages;
};

/// Reads it from its beginning, record by record, and holds index and statistics to what is there. Throws InternalError
/// naming file and byte.
Bag read_mcap(std::string_view bytes, const std::string& file_name);

}  // namespace seampath::exporting
