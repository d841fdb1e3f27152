#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <numbers>

#include "pipeline/text.hpp"
#include "stages/text.hpp"
#include "tests/calibrate/cases.hpp"

/// seampath_fixture [SETS]: every case over so many seeds, 100 without.
namespace seampath {
namespace {

using Rows = std::vector<std::vector<std::string>>;

template <class F>
void run(Rows& rows, const std::string& name, const std::string& asked, const F& f) {
    const auto start = std::chrono::steady_clock::now();
    const CaseResult r = f();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    rows.push_back({name, asked, std::to_string(r.sets), fixed(r.rms_mm, 5), fixed(r.largest_mm, 5),
                    fixed(r.largest_rad * 180 / std::numbers::pi, 5), std::to_string(r.inside), std::to_string(r.good),
                    fixed(seconds / r.sets, 2), r.good == r.sets ? "" : r.note});
    std::cerr << name << ": " << r.good << " of " << r.sets << "\n";
}

void print(int sets) {
    Rows rows{{"case", "asked", "sets", "rms mm", "largest mm", "largest deg", "in 95 %", "good", "s a set",
               "first that is not"}};
    run(rows, "four balls", "rms <= 0.01, in 95 %: 90 to 98", [&] { return ball_case(1, sets); });
    run(rows, "one ball moved", ">= 99 %", [&] { return moved_ball_case(1, sets); });
    run(rows, "best fit to a mesh", ">= 99 % within 0.02 mm, 0.005 deg", [&] { return surface_case(1, sets); });
    run(rows, "best fit, open or alike", "all named", [&] { return open_surface_case(1, sets); });
    std::cout << aligned(rows);
}

}  // namespace
}  // namespace seampath

int main(int argc, char** argv) {
    const int sets = argc > 1 ? std::atoi(argv[1]) : 100;
    seampath::print(std::max(1, sets));
}
