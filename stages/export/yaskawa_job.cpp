#include "stages/export/yaskawa_job.hpp"

#include <cmath>

namespace seampath::exporting {
namespace {

constexpr std::size_t kLongestJobName = 32;
constexpr std::size_t kLongestComment = 32;

// A line that begins so; what follows is left.
void heading(Scanner& scan, const char* text) {
    require(scan.accept(text), scan, text);
}

void heading_line(Scanner& scan, const char* text) {
    heading(scan, text);
    scan.end_line();
}

std::array<double, 6> six_numbers(Scanner& scan) {
    std::array<double, 6> n{};
    for (std::size_t i = 0; i < 6; ++i) {
        if (i > 0) {
            scan.expect(',');
        }
        n[i] = scan.number();
    }
    return n;
}

std::array<double, 6> pose(Scanner& scan) {
    const std::array<double, 6> n = six_numbers(scan);
    for (std::size_t i = 3; i < 6; ++i) {
        require(std::abs(n[i]) <= 180, scan, "an angle within 180 deg");
    }
    return n;
}

std::array<double, 6> pulses(Scanner& scan) {
    const std::array<double, 6> n = six_numbers(scan);
    for (const double axis : n) {
        require(axis == std::floor(axis), scan, "whole pulses");
    }
    return n;
}

// What the positions that follow are in: true for pulses.
bool position_type(Scanner& scan, YaskawaJob& job) {
    std::string frame = "BASE";
    if (scan.accept("///USER")) {
        frame = "USER " + plain(whole_number(scan));
        scan.end_line();
    }
    heading(scan, "///TOOL");
    whole_number(scan);
    scan.end_line();
    heading(scan, "///POSTYPE");
    const std::string type = scan.name();
    scan.end_line();
    if (type == "PULSE") {
        heading_line(scan, "///PULSE");
        return true;
    }
    require(type == frame.substr(0, 4) && (job.frame.empty() || job.frame == frame), scan,
            "PULSE, or the one frame of all positions, " + frame.substr(0, 4) + ",");
    job.frame = frame;
    heading_line(scan, "///RECTAN");
    heading(scan, "///RCONF");
    int numbers = 0;
    do {
        require(whole_number(scan) <= 1, scan, "0 or 1");
        ++numbers;
    } while (scan.accept(','));
    require(numbers >= 6 && numbers <= 24, scan, "6 to 24 numbers");
    scan.end_line();
    return false;
}

void positions(Scanner& scan, YaskawaJob& job, double count) {
    bool by_axes = position_type(scan, job);
    for (double i = 0; i < count; ++i) {
        if (!scan.accept('C')) {
            by_axes = position_type(scan, job);
            scan.expect('C');
        }
        require(whole_number(scan) == i, scan, "the next position");
        scan.expect('=');
        if (by_axes) {
            job.pulses[i] = pulses(scan);
        } else {
            job.poses[i] = pose(scan);
        }
        scan.end_line();
    }
}

// 1970/01/01 00:00
void date(Scanner& scan) {
    whole_number(scan);
    for (const char before : {'/', '/', '\0', ':'}) {
        if (before != '\0') {
            scan.expect(before);
        }
        whole_number(scan);
    }
}

}  // namespace

double whole_number(Scanner& scan) {
    const double n = scan.number();
    require(n >= 0 && n == std::floor(n), scan, "a whole number");
    return n;
}

YaskawaJob load_yaskawa(const TextFile& file) {
    require_crlf_ascii(file);
    Scanner scan(file, '\0', Scanner::Lines::kept);
    YaskawaJob job;
    heading_line(scan, "/JOB");
    heading(scan, "//NAME");
    job.name = scan.name();
    require(job.name.size() <= kLongestJobName && file.name == job.name + ".jbi", scan,
            "the file's name, of at most 32 characters");
    scan.end_line();
    heading_line(scan, "//POS");
    heading(scan, "///NPOS");
    const double count = whole_number(scan);
    for (int i = 0; i < 5; ++i) {
        scan.expect(',');
        require(whole_number(scan) == 0, scan, "no other positions");
    }
    scan.end_line();
    if (count > 0) {
        positions(scan, job, count);
    }
    heading_line(scan, "//INST");
    heading(scan, "///DATE");
    date(scan);
    scan.end_line();
    heading(scan, "///COMM");
    require(scan.to_line_end().size() <= kLongestComment + 1, scan, "a comment of at most 32 characters");
    scan.end_line();
    heading_line(scan, "///ATTR SC,RW,RJ");
    heading(scan, "////FRAME");
    const std::string frame = scan.to_line_end();
    require(job.frame.empty() || frame == " " + job.frame, scan, "the frame of the positions");
    scan.end_line();
    heading_line(scan, "///GROUP1 RB1");
    heading_line(scan, "NOP");
    while (!scan.accept("END")) {
        require(!scan.done(), scan, "END");
        job.lines.push_back(scan);
        const std::string line = scan.to_line_end();
        job.comments += line.starts_with("'") ? line.substr(1) + " " : "";
        scan.end_line();
    }
    scan.end_line();
    require(scan.done(), scan, "the end of the file");
    return job;
}

}  // namespace seampath::exporting
