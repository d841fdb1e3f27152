#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace seampath {

/// One object of a JSON file that a user wrote, with its place in it, e.g. "/camera". What is wrong with its values is
/// collected in `problems`, as "/camera/size_px: ..."; a key that is not among `keys` is wrong.
class JsonObject {
public:
    using Json = nlohmann::ordered_json;

    /// A null is an object in which every key is missing. `value` and `problems` outlive this.
    JsonObject(const Json& value, std::string place, std::vector<std::string>& problems,
               std::vector<std::string_view> keys);

    bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
    std::string place_of(const std::string& key) const { return place_ + "/" + key; }
    void complain(const std::string& key, const std::string& what) const;

    /// Null, which is complained of, where the key is missing.
    const Json& member(const char* key) const;

    /// So many numbers; empty, which is complained of, for anything else.
    std::vector<double> numbers(const char* key, std::size_t count) const;
    std::vector<double> numbers_of(const Json& value, const std::string& key, std::size_t count) const;
    double number(const char* key) const;

    /// A number above 0; `otherwise`, where there is no such key.
    double positive(const char* key, double otherwise) const;
    std::string text(const char* key) const;

    /// Index of one of a few words; 0, which is complained of, for anything else.
    std::size_t word(const char* key, std::span<const std::string_view> words) const;

    std::vector<std::string>& problems() const { return problems_; }

private:
    const Json& value_;
    std::string place_;
    std::vector<std::string>& problems_;
};

/// Reads a JSON file and calls `take` with its root; throws one InputError with all problems, a line each: "file:
/// /camera/size_px: ...". `who` begins the message of a file that is none, `what` says what was needed.
void read_json_file(const std::filesystem::path& file, std::size_t max_bytes, const std::string& who,
                    const std::string& what,
                    const std::function<void(const JsonObject::Json& root, std::vector<std::string>& problems)>& take);

}  // namespace seampath
