#include <chrono>
#include <cstdlib>
#include <iostream>

#include "pipeline/text.hpp"
#include "stages/text.hpp"
#include "tests/accuracy/joint_rows.hpp"

/// seampath_joints [SEEDS [WORD]]: what every kind of joint reaches over so many seeds, 5 without; with a word those
/// rows that have it in their name. A line a row, as soon as it is done. Rows of sigma take 40 scans for each seed.
/// `common` is how far the views' shifts, which the scan does not show, move a seam whatever is done (rms over all
/// scans); `apart` what is left beside that. No method comes below `common`, but by luck.
namespace seampath {
namespace {

std::string pair_of(double rms, double max) {
    return fixed(rms, 4) + " / " + fixed(max, 4);
}

std::string asked_of(const JointLimits& l) {
    if (l.sigma) {
        return "60 to 76, 92 to 98 %";
    }
    if (!l.off) {
        return "never wrong";
    }
    std::string text = fixed(l.off->rms_mm, 3) + " / " + fixed(l.off->max_mm, 3);
    if (l.depth) {
        text += ", " + fixed(l.depth->rms_mm, 3) + " / " + fixed(l.depth->max_mm, 3);
    }
    return text;
}

std::string share(std::size_t part, std::size_t all) {
    return all ? fixed(100 * static_cast<double>(part) / static_cast<double>(all), 1) : "-";
}

std::vector<std::string> line_of(const JointRow& row, const JointResult& r, double seconds) {
    std::string misses;
    for (const std::string& miss : missed(r, row.asked)) {
        misses += (misses.empty() ? "" : "; ") + miss;
    }
    return {row.name,
            asked_of(row.asked),
            std::to_string(r.scans),
            fixed(r.all_rms_mm, 4),
            pair_of(r.rms_mm, r.max_mm),
            row.asked.depth ? pair_of(r.across_rms_mm, r.across_max_mm) : "",
            row.asked.depth ? pair_of(r.depth_rms_mm, r.depth_max_mm) : "",
            fixed(r.common_mm, 4),
            fixed(r.apart_mm, 4),
            fixed(100 * r.found, 1),
            fixed(100 * r.false_share, 1),
            fixed(100 * r.within_1_sigma, 1) + ", " + fixed(100 * r.within_2_sigma, 1),
            share(r.parameters_1_sigma, r.parameters) + ", " + share(r.parameters_2_sigma, r.parameters),
            std::to_string(r.passed) + " of " + std::to_string(r.seams),
            std::to_string(r.wrong),
            fixed(seconds / r.scans, 1),
            misses};
}

bool print(int seeds, const std::string& word) {
    const std::vector<std::string> heads{"joint",    "asked, mm",       "scans",        "rms, all", "worst rms / max",
                                         "across",   "in depth",        "common",       "apart",    "found %",
                                         "false %",  "in 1, 2 sigma %", "parameters %", "passed",   "wrong",
                                         "s a scan", "missed"};
    std::vector<std::vector<std::string>> table{heads};
    bool holds = true;
    for (const JointRow& row : joint_rows()) {
        if (row.name.find(word) == std::string::npos) {
            continue;
        }
        const auto start = std::chrono::steady_clock::now();
        const JointResult result = measure_row(row, 1, seeds * row.scans);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        table.push_back(line_of(row, result, seconds));
        holds = holds && missed(result, row.asked).empty();
        std::string line;
        for (std::size_t i = 0; i < heads.size(); ++i) {
            line += (i == 0 ? "" : "; " + heads[i] + " ") + table.back()[i];
        }
        std::cerr << line << "\n";
    }
    std::cout << aligned(table);
    return holds;
}

}  // namespace
}  // namespace seampath

int main(int argc, char** argv) {
    const int seeds = argc > 1 ? std::atoi(argv[1]) : 5;
    return seampath::print(std::max(1, seeds), argc > 2 ? argv[2] : "") ? 0 : 1;
}
