#include <chrono>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <numbers>

#include "pipeline/text.hpp"
#include "stages/text.hpp"
#include "tests/calibrate/cases.hpp"

/// seampath_fixture [SETS [WORD]]: every case over so many seeds, 100 without; with a word those that have it in their
/// name. A line a case, as soon as it is done.
namespace seampath {
namespace {

struct TableRow {
    std::string name, asked;
    std::function<CaseResult(int sets)> run;
};

const std::vector<TableRow>& table_rows() {
    static const std::vector<TableRow> rows{
        {"four balls", "rms <= 0.01 mm, 90 to 98 % inside", [](int sets) { return ball_case(1, sets); }},
        {"one ball moved", ">= 99 % named", [](int sets) { return moved_ball_case(1, sets); }},
        {"three points", "rms/sigma 1, 90 to 98 % inside",
         [](int sets) { return touched_case(Touched::three_points, 1, sets); }},
        {"planes 3-2-1", "rms/sigma 1, 90 to 98 % inside",
         [](int sets) { return touched_case(Touched::planes, 1, sets); }},
        {"planes 3-2-1 of a scan", "rms/sigma 1, 90 to 98 % inside", [](int sets) { return probed_case(1, sets); }},
        {"points, all", "rms/sigma 1, 90 to 98 % inside",
         [](int sets) { return touched_case(Touched::points, 1, sets); }},
        {"board", "rms/sigma 1, 90 to 98 % inside", [](int sets) { return board_case(1, sets); }},
        {"seams", "rms/sigma 1, 90 to 98 % inside", [](int sets) { return seam_case(1, sets); }},
        {"best fit, open or alike", "all named", [](int sets) { return open_surface_case(1, sets); }},
        {"best fit to a mesh", ">= 99 % within 0.02 mm, 0.005 deg", [](int sets) { return surface_case(1, sets); }},
        {"best fit to a golden scan", "all right or refused", [](int sets) { return golden_case(1, sets); }},
        {"golden scan, same side", "all right", [](int sets) { return same_side_case(1, sets); }},
    };
    return rows;
}

void print(int sets, const std::string& word) {
    const std::vector<std::string> heads{"case",        "asked",  "sets",        "rms mm", "over sigma", "largest mm",
                                         "largest deg", "inside", "of measured", "good",   "s a set",    "first not"};
    std::vector<std::vector<std::string>> table{heads};
    for (const TableRow& row : table_rows()) {
        if (row.name.find(word) == std::string::npos) {
            continue;
        }
        const auto start = std::chrono::steady_clock::now();
        const CaseResult r = row.run(sets);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        table.push_back({row.name, row.asked, std::to_string(r.sets), fixed(r.rms_mm, 5),
                         r.sigma_mm > 0 ? fixed(r.rms_mm / r.sigma_mm, 2) : "-", fixed(r.largest_mm, 5),
                         fixed(r.largest_rad * 180 / std::numbers::pi, 5), std::to_string(r.inside),
                         std::to_string(r.measured), std::to_string(r.good), fixed(seconds / r.sets, 2),
                         r.good == r.sets ? "" : r.note});
        std::string line;
        for (std::size_t i = 0; i < heads.size(); ++i) {
            line += (i == 0 ? "" : "; " + heads[i] + " ") + table.back()[i];
        }
        std::cerr << line << "\n";
    }
    std::cout << aligned(table);
}

}  // namespace
}  // namespace seampath

int main(int argc, char** argv) {
    const int sets = argc > 1 ? std::atoi(argv[1]) : 100;
    seampath::print(std::max(1, sets), argc > 2 ? argv[2] : "");
}
