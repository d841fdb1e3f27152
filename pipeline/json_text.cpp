#include "pipeline/json_text.hpp"

#include <set>
#include <vector>

#include <nlohmann/json.hpp>

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxDepth = 64;

/// Called by the parser at every event; refuses what the parser itself lets pass.
class Guard {
public:
    bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
        if (depth > kMaxDepth) {
            throw JsonError("more than " + std::to_string(kMaxDepth) + " levels of nesting");
        }
        if (event == Json::parse_event_t::object_start) {
            keys_.emplace_back();
        } else if (event == Json::parse_event_t::object_end) {
            keys_.pop_back();
        } else if (event == Json::parse_event_t::key && !keys_.back().insert(parsed.get<std::string>()).second) {
            throw JsonError("key " + json_excerpt(parsed) + " stands twice in one object");
        }
        return true;
    }

private:
    std::vector<std::set<std::string>> keys_;
};

}  // namespace

Json parse_json(std::string_view text) {
    Guard guard;
    try {
        return Json::parse(text.begin(), text.end(), std::ref(guard), true, true);
    } catch (const Json::exception& error) {
        // "[json.exception.parse_error.101] parse error at line 3, column 5: ..." without the library's own number
        const std::string what = error.what();
        const auto bracket = what.find("] ");
        throw JsonError(bracket == std::string::npos ? what : what.substr(bracket + 2));
    }
}

bool is_utf8(std::string_view text) {
    try {
        return !Json(text).dump().empty();
    } catch (const Json::type_error&) {
        return false;
    }
}

std::string json_excerpt(const Json& value) {
    const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return text.size() <= 80 ? text : text.substr(0, 77) + "...";
}

}  // namespace seampath
