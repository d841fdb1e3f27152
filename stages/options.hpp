#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// One list of fields per options struct. It drives reading, writing, bounds, help, schema and cache keys, so that an
/// option is declared once: as a member with its default, and as one line of `describe()`.
namespace seampath {

/// Range of a number; `low_open` leaves `low` itself out.
struct Bounds {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_open = false;
};
inline Bounds above(double low) {
    return {low, std::numeric_limits<double>::infinity(), true};
}
inline Bounds at_least(double low) {
    return {low, std::numeric_limits<double>::infinity(), false};
}
inline Bounds within(double low, double high) {
    return {low, high, false};
}

/// One of a few names.
struct Choice {
    std::vector<std::string_view> names;
    std::function<int()> get;
    std::function<void(int)> set;
};

using FieldValue =
    std::variant<bool*, int*, double*, std::string*, std::optional<double>*, std::vector<double>*, Choice>;

/// `key` ends in its unit; `meaning` is one line; for a vector<double>, `length` is how many numbers it must hold.
struct Field {
    std::string_view key;
    FieldValue value;
    std::string_view meaning;
    Bounds bounds = {};
    int length = 0;
};
using Fields = std::vector<Field>;

/// A Choice over an enum whose values count from 0 in the order of `names`.
template <class Enum, class Names>
Choice choice(Enum& value, const Names& names) {
    return {{names.begin(), names.end()},
            [&value] { return static_cast<int>(value); },
            [&value](int i) { value = static_cast<Enum>(i); }};
}

}  // namespace seampath
