#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "stages/options.hpp"

/// Values of a suite's JSON, checked.
namespace seampath {

/// What is wrong in the file, each with its place, said once.
class SuiteProblems {
public:
    explicit SuiteProblems(std::string file) : file_(std::move(file)) {}
    void add(const std::string& place, const std::string& what);
    /// Throws one InputError with a line for each.
    void throw_if_any() const;

private:
    std::string file_, lines_;
    std::set<std::string> seen_;
};

using KeyNames = std::vector<std::string_view>;

/// Sets the fields that the object names. `others` are keys that are read elsewhere; any further one is a problem.
void read_fields(const nlohmann::ordered_json& object, const Fields& fields, const KeyNames& others,
                 const std::string& place, SuiteProblems& problems);

/// The member of that key, or null.
const nlohmann::ordered_json& member_of(const nlohmann::ordered_json& object, const char* key);

/// A list of texts; empty for null.
std::vector<std::string> texts_of(const nlohmann::ordered_json& list, const std::string& place,
                                  SuiteProblems& problems);

/// A number of seeds, from 1, or a list of them.
std::vector<std::uint64_t> seeds_of(const nlohmann::ordered_json& json, const std::string& place,
                                    SuiteProblems& problems);

}  // namespace seampath
