#include "stages/export/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

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

}  // namespace

std::string plain(double value) {
    std::array<char, kLongestNumber> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed).ptr};
}

std::string list(const std::vector<double>& values, std::string_view separator) {
    std::string text;
    for (const double value : values) {
        text += (text.empty() ? "" : std::string(separator)) + shortest(value);
    }
    return text;
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

std::vector<std::string> preamble(const Plan& in_base, const ExportOptions& options, double rounding_mm) {
    const auto& b = options.base_from_scan;
    std::vector<std::string> lines{"Written by Seampath.",
                                   "Frame: robot base; base_from_scan is " + list({b[0], b[1], b[2]}, " ") +
                                       " mm, quaternion w x y z " + list({b[3], b[4], b[5], b[6]}, " ") + ".",
                                   "Tool: +Z along the torch into the joint, +X along travel.",
                                   "Straight moves stay within " +
                                       fixed(std::ceil(in_base.max_chord_error_mm * 1e4) / 1e4, 4) +
                                       " mm of the seam."};
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
        } else if (text[at_] == ' ' || text[at_] == '\t' || text[at_] == '\r' || text[at_] == '\n') {
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
    const std::string result(left.begin(), end);
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

std::string Scanner::quoted() {
    expect('"');
    const auto end = file_->text.find('"', at_);
    if (end == std::string::npos) {
        fail("a closing quote");
    }
    const std::string result = file_->text.substr(at_, end - at_);
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
