#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "stages/angle.hpp"
#include "stages/export/format.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/text.hpp"

/// Private to the export stage: numbers, names and a scanner for the readers.
namespace seampath::exporting {

/// Largest coordinate of a format that holds any, mm.
inline constexpr double kAnywhere = std::numeric_limits<double>::infinity();

/// "waypoint 3 of seam 0"
std::string place(const Waypoint& waypoint);

/// Shortest form that reads back exactly and has no exponent, for robot languages and messages.
std::string plain(double value);

/// An angle in rad as degrees with so many decimals, above -180 where it is written.
std::string degrees(double rad, int decimals);

/// Angles of an arm's axes in rad as degrees with so many decimals; whole turns and signs are theirs to keep.
std::vector<std::string> axis_degrees(const std::array<double, 6>& q, int decimals);

/// "a,b,c"
std::string joined(const std::vector<std::string>& parts, std::string_view separator);

/// "a,b,c" of shortest numbers.
std::string list(const std::vector<double>& values, std::string_view separator);

std::string lower(std::string_view text);

/// [A-Za-z][A-Za-z0-9_]*
bool is_identifier(std::string_view text);

/// `stem` and a number: "speed12".
bool is_numbered(std::string_view name, std::string_view stem);

/// "key: "value" is ...": why `value` is no name of at most `longest` characters outside `reserved` (lower case), or
/// nothing.
std::vector<std::string> name_problems(std::string_view key, const std::string& value, std::size_t longest,
                                       const std::vector<std::string_view>& reserved, std::string_view language);

/// "key: 1.5 is no ...": why a number of the config is none of `what`, whole and from low to high; nothing when it is,
/// or was not given.
std::vector<std::string> number_problems(std::string_view key, const std::optional<double>& value, double low,
                                         double high, std::string_view what);

/// The same where the language can't do without it.
std::vector<std::string> needed_number_problems(std::string_view key, const std::optional<double>& value, double low,
                                                double high, std::string_view what);

void append(std::vector<std::string>& to, const std::vector<std::string>& more);

/// Every line end as carriage return and line feed.
std::string crlf(const std::string& text);

/// Throws InternalError where a line end is another, or a byte is no printable ASCII character or tab.
void require_crlf_ascii(const TextFile& file);

std::size_t line_count(std::string_view text);

/// Lines of at most `width` characters, broken between words.
std::vector<std::string> wrapped(const std::vector<std::string>& lines, std::size_t width);

/// Lines that say frame, tool, units and tolerance at the head of a program.
std::vector<std::string> preamble(const Program& program, const ExportOptions& options, double rounding_mm);

/// Walks over the tokens of a file, which must outlive it; blanks, line ends and comments lie between them. In a
/// language whose statements end with their line, `Lines::kept`, line ends are tokens. All but accept() and done()
/// throw InternalError naming file and line when the text is not what they need.
class Scanner {
public:
    enum class Lines { skipped, kept };
    Scanner(const TextFile& file, char comment, Lines lines = Lines::skipped)
        : file_(&file), comment_(comment), lines_(lines) {}

    bool done();
    bool at_line_end();
    void end_line();            ///< at least one line end
    std::string to_line_end();  ///< what is left of the line, comments and all
    bool accept(char token);
    bool accept(std::string_view token);  ///< punctuation
    void expect(char token);
    bool at_name();
    bool at_quote();
    std::string name();
    double number();
    char letter();         ///< one, upper case
    double decimal();      ///< a number without an exponent
    std::string quoted();  ///< "..." without escapes
    [[noreturn]] void fail(const std::string& needed) const;

private:
    void skip();
    std::string_view rest() const { return std::string_view(file_->text).substr(at_); }

    const TextFile* file_;
    char comment_;
    Lines lines_;
    std::size_t at_ = 0;
};

/// Fails at a place of a file, saying what was needed before it.
inline void require(bool holds, const Scanner& place, const std::string& needed) {
    if (!holds) {
        place.fail(needed + " before this place");
    }
}

/// A move along the axes to these angles, deg; where that puts the tool the file does not tell.
inline Target axes_target(const std::array<double, 6>& q_deg) {
    Target target;
    target.move = Move::joint;
    target.at.kind = WaypointKind::air;
    target.at.p.setConstant(std::numeric_limits<double>::quiet_NaN());
    target.at.speed_mm_s = std::numeric_limits<double>::quiet_NaN();
    target.axes.resize(1);
    for (std::size_t i = 0; i < q_deg.size(); ++i) {
        target.axes[0].q[i] = std::numbers::pi / 180 * q_deg[i];
    }
    return target;
}

/// Rz(z) Ry(y) Rx(x), deg.
inline Eigen::Quaterniond turned(double z_deg, double y_deg, double x_deg) {
    return from_euler_zyx(z_deg * kDegree, y_deg * kDegree, x_deg * kDegree);
}

}  // namespace seampath::exporting
