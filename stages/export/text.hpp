#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stages/export/format.hpp"
#include "stages/text.hpp"

/// Private to the export stage: numbers, names and a scanner for the readers.
namespace seampath::exporting {

/// Shortest form that reads back exactly and has no exponent, for robot languages and messages.
std::string plain(double value);

/// "a,b,c" of shortest numbers.
std::string list(const std::vector<double>& values, std::string_view separator);

std::string lower(std::string_view text);

/// [A-Za-z][A-Za-z0-9_]*
bool is_identifier(std::string_view text);

/// "key: "value" is ...": why `value` is no name of at most `longest` characters outside `reserved` (lower case), or
/// nothing.
std::vector<std::string> name_problems(std::string_view key, const std::string& value, std::size_t longest,
                                       const std::vector<std::string_view>& reserved, std::string_view language);

/// Lines that say frame, tool, units and tolerance at the head of a program.
std::vector<std::string> preamble(const Plan& in_base, const ExportOptions& options, double rounding_mm);

/// Walks over the tokens of a file, which must outlive it; blanks, line ends and comments lie between them. All but
/// accept() and done() throw InternalError naming file and line when the text is not what they need.
class Scanner {
public:
    Scanner(const TextFile& file, char comment) : file_(&file), comment_(comment) {}

    bool done();
    bool accept(char token);
    bool accept(std::string_view token);  ///< punctuation
    void expect(char token);
    bool at_name();
    bool at_quote();
    std::string name();
    double number();
    std::string quoted();  ///< "..." without escapes
    [[noreturn]] void fail(const std::string& needed) const;

private:
    void skip();
    std::string_view rest() const { return std::string_view(file_->text).substr(at_); }

    const TextFile* file_;
    char comment_;
    std::size_t at_ = 0;
};

}  // namespace seampath::exporting
