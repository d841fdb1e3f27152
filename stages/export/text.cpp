#include "stages/export/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "stages/error.hpp"

namespace seampath::exporting {
namespace {

// The largest double has 309 digits before the point, the smallest 324 zeros and 17 digits behind it.
constexpr std::size_t kLongestNumber = 352;

// Locale has no say in what a letter is.
bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
bool is_part_of_name(char c) {
    return is_letter(c) || is_digit(c) || c == '_';
}

// Names from other files may be in any encoding; programs are ASCII.
std::string ascii(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return text;
}

}  // namespace

std::string place(const Waypoint& waypoint) {
    return "waypoint " + std::to_string(waypoint.index) + " of seam " + std::to_string(waypoint.seam);
}

std::string plain(double value) {
    std::array<char, kLongestNumber> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed).ptr};
}

std::string degrees(double rad, int decimals) {
    const std::string text = fixed(180 / std::numbers::pi * rad, decimals);
    return text == fixed(-180, decimals) ? text.substr(1) : text;
}

std::vector<std::string> axis_degrees(const std::array<double, 6>& q, int decimals) {
    std::vector<std::string> texts;
    for (const double rad : q) {
        texts.push_back(fixed(180 / std::numbers::pi * rad, decimals));
    }
    return texts;
}

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
    std::string text;
    for (const std::string& part : parts) {
        text += (&part == &parts.front() ? "" : std::string(separator)) + part;
    }
    return text;
}

std::string list(const std::vector<double>& values, std::string_view separator) {
    std::vector<std::string> texts;
    for (const double value : values) {
        texts.push_back(shortest(value));
    }
    return joined(texts, separator);
}

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result) {
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return result;
}

bool is_identifier(std::string_view text) {
    return !text.empty() && is_letter(text.front()) && std::all_of(text.begin(), text.end(), is_part_of_name);
}

bool is_numbered(std::string_view name, std::string_view stem) {
    return name.size() > stem.size() && name.starts_with(stem) &&
           std::all_of(name.begin() + static_cast<std::ptrdiff_t>(stem.size()), name.end(), is_digit);
}

std::vector<std::string> name_problems(std::string_view key, const std::string& value, std::size_t longest,
                                       const std::vector<std::string_view>& reserved, std::string_view language) {
    const std::string what = std::string(key) + ": \"" + value + "\" ";
    if (!is_identifier(value)) {
        return {what + "is no name in " + std::string(language) +
                "; a letter was needed, then letters, digits and underscores"};
    }
    if (value.size() > longest) {
        return {what + "has " + std::to_string(value.size()) + " characters; at most " + std::to_string(longest) +
                " are needed for " + std::string(language)};
    }
    if (std::find(reserved.begin(), reserved.end(), lower(value)) != reserved.end()) {
        return {what + "is a word of " + std::string(language) + " itself; another name is needed"};
    }
    return {};
}

std::vector<std::string> number_problems(std::string_view key, const std::optional<double>& value, double low,
                                         double high, std::string_view what) {
    if (!value || (*value >= low && *value <= high && *value == std::floor(*value))) {
        return {};
    }
    return {std::string(key) + ": " + plain(*value) + " is no " + std::string(what) + "; a whole number from " +
            plain(low) + " to " + plain(high) + " was needed"};
}

std::vector<std::string> needed_number_problems(std::string_view key, const std::optional<double>& value, double low,
                                                double high, std::string_view what) {
    if (!value) {
        return {std::string(key) + ": no " + std::string(what) + " was given; a whole number from " + plain(low) +
                " to " + plain(high) + " was needed"};
    }
    return number_problems(key, value, low, high, what);
}

void append(std::vector<std::string>& to, const std::vector<std::string>& more) {
    to.insert(to.end(), more.begin(), more.end());
}

std::string crlf(const std::string& text) {
    std::string result;
    for (const char c : text) {
        result += c == '\n' ? "\r\n" : std::string(1, c);
    }
    return result;
}

void require_crlf_ascii(const TextFile& file) {
    const std::string& text = file.text;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const bool paired = c == '\n'   ? i > 0 && text[i - 1] == '\r'
                            : c == '\r' ? i + 1 < text.size() && text[i + 1] == '\n'
                                        : c == '\t' || (c >= ' ' && c <= '~');
        if (!paired) {
            throw InternalError("export: " + file.name + ":" + std::to_string(line_count(text.substr(0, i)) + 1) +
                                ": ASCII and line ends of carriage return and line feed were needed");
        }
    }
}

std::size_t line_count(std::string_view text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::vector<std::string> wrapped(const std::vector<std::string>& lines, std::size_t width) {
    std::vector<std::string> result;
    for (std::string_view left : lines) {
        while (left.size() > width) {
            const auto blank = left.rfind(' ', width);
            const std::size_t end = blank == std::string_view::npos || blank == 0 ? width : blank;
            result.emplace_back(left.substr(0, end));
            left.remove_prefix(end == blank ? end + 1 : end);
        }
        result.emplace_back(left);
    }
    return result;
}

std::vector<std::string> preamble(const Program& program, const ExportOptions& options, double rounding_mm) {
    const auto& b = options.base_from_scan;
    std::string sigma;
    if (options.base_from_scan_sigma_mm) {
        sigma += " " + plain(*options.base_from_scan_sigma_mm) + " mm";
    }
    if (options.base_from_scan_sigma_deg) {
        sigma += (sigma.empty() ? " " : ", ") + plain(*options.base_from_scan_sigma_deg) + " deg";
    }
    std::vector<std::string> lines{
        "Written by Seampath.",
        "Frame: robot base; base_from_scan is " + list({b[0], b[1], b[2]}, " ") + " mm, quaternion w x y z " +
            list({b[3], b[4], b[5], b[6]}, " ") + ".",
        "Tool: +Z along the torch into the joint, +X along travel.",
        "Moves stay within " + fixed(std::ceil(program.deviation_mm * 1e4) / 1e4, 4) + " mm of the seam."};
    if (!sigma.empty()) {
        lines.insert(lines.begin() + 2, "1-sigma of base_from_scan:" + sigma + ".");
    }
    const auto by_axes = [](const Target& target) { return !target.axes.empty(); };
    if (std::any_of(program.targets.begin(), program.targets.end(), by_axes)) {
        lines.push_back("Axes are those of " + ascii(program.plan.arm->arm) + " standing in that base.");
    }
    if (rounding_mm > 0) {
        lines.push_back("Positions are rounded by up to " + plain(rounding_mm) + " mm.");
    }
    return lines;
}

void Scanner::skip() {
    const std::string& text = file_->text;
    while (at_ < text.size()) {
        if (text[at_] == comment_ && comment_ != 0) {
            at_ = std::min(text.find('\n', at_), text.size());
        } else if (text[at_] == ' ' || text[at_] == '\t' || text[at_] == '\r' ||
                   (text[at_] == '\n' && lines_ == Lines::skipped)) {
            ++at_;
        } else {
            return;
        }
    }
}

bool Scanner::done() {
    skip();
    return at_ == file_->text.size();
}

bool Scanner::at_line_end() {
    return done() || rest().front() == '\n';
}

void Scanner::end_line() {
    if (!at_line_end()) {
        fail("the end of the line");
    }
    while (!done() && rest().front() == '\n') {
        ++at_;
    }
}

std::string Scanner::to_line_end() {
    std::string line(rest().substr(0, rest().find('\n')));
    at_ += line.size();
    if (!line.empty() && line.back() == '\r') {
        line.pop_back();
    }
    return line;
}

bool Scanner::accept(char token) {
    return accept(std::string_view(&token, 1));
}

bool Scanner::accept(std::string_view token) {
    skip();
    if (!rest().starts_with(token)) {
        return false;
    }
    at_ += token.size();
    return true;
}

void Scanner::expect(char token) {
    if (!accept(token)) {
        fail(std::string("'") + token + "'");
    }
}

bool Scanner::at_name() {
    return !done() && (is_letter(rest().front()) || rest().front() == '_');
}

bool Scanner::at_quote() {
    return !done() && rest().front() == '"';
}

std::string Scanner::name() {
    if (!at_name()) {
        fail("a name");
    }
    const std::string_view left = rest();
    const auto end = std::find_if_not(left.begin(), left.end(), is_part_of_name);
    std::string result(left.begin(), end);
    at_ += result.size();
    return result;
}

double Scanner::number() {
    skip();
    const std::string_view left = rest();
    double value = 0;
    const auto [end, error] = std::from_chars(left.data(), left.data() + left.size(), value);
    if (error != std::errc() || !std::isfinite(value)) {
        fail("a number");
    }
    at_ += static_cast<std::size_t>(end - left.data());
    return value;
}

char Scanner::letter() {
    if (done() || rest().front() < 'A' || rest().front() > 'Z') {
        fail("a letter");
    }
    return file_->text[at_++];
}

double Scanner::decimal() {
    skip();
    const std::string_view left = rest();
    double value = 0;
    const auto [end, error] = std::from_chars(left.data(), left.data() + left.size(), value, std::chars_format::fixed);
    if (error != std::errc() || !std::isfinite(value)) {
        fail("a number");
    }
    at_ += static_cast<std::size_t>(end - left.data());
    return value;
}

std::string Scanner::quoted() {
    expect('"');
    const auto end = file_->text.find('"', at_);
    if (end == std::string::npos) {
        fail("a closing quote");
    }
    std::string result = file_->text.substr(at_, end - at_);
    at_ = end + 1;
    return result;
}

void Scanner::fail(const std::string& needed) const {
    const auto line = std::count(file_->text.begin(), file_->text.begin() + static_cast<std::ptrdiff_t>(at_), '\n') + 1;
    const std::string_view left = rest();
    throw InternalError("export: " + file_->name + ":" + std::to_string(line) + ": " + needed + " was needed where \"" +
                        std::string(left.substr(0, std::min<std::size_t>(left.find('\n'), 30))) + "\" stands");
}

}  // namespace seampath::exporting
