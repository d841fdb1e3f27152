#include "tools/interpolation_run.hpp"

#include <iostream>

#include <nlohmann/json.hpp>

#include "pipeline/stored_run.hpp"
#include "stages/error.hpp"
#include "stages/geometry/seam_pieces.hpp"
#include "tools/exit_status.hpp"
#include "tools/interpolation_seams.hpp"
#include "tools/output.hpp"

namespace seampath {
namespace {

std::vector<std::size_t> node_counts(const std::vector<int>& given) {
    std::vector<std::size_t> counts;
    for (const int count : given) {
        if (count < 4 || (!counts.empty() && static_cast<std::size_t>(count) <= counts.back())) {
            throw InputError("--nodes: " + std::to_string(count) + "; numbers from 4 on, ascending, were needed");
        }
        counts.push_back(static_cast<std::size_t>(count));
    }
    return counts;
}

/// What is printed of one seam: for people and for machines.
struct SeamReport {
    std::string text;
    nlohmann::ordered_json json;
};

/// The line of least rms is validated as a run would.
SeamReport report_on(const SeamComparison& comparison, const Deviation& deviation) {
    const std::string& best = comparison.best.label;
    SeamReport report{
        seam_comparison_text(comparison) + "\nleast rms: " + best + "\nvalidated: " + deviation.verdict + "\n",
        seam_comparison_json(comparison)};
    report.json["best"] = {{"line", best}, {"pass", deviation.pass}, {"verdict", deviation.verdict}};
    return report;
}

/// A line without corners: a seam, or what lies between two of its corners.
struct SmoothSeam {
    std::string name;
    Seam seam;
};

std::vector<SmoothSeam> smooth_seams(const std::vector<Seam>& seams) {
    std::vector<SmoothSeam> smooth;
    for (std::size_t i = 0; i < seams.size(); ++i) {
        const std::string name = "seam " + std::to_string(i);
        if (seams[i].corners.empty()) {
            smooth.push_back({name, seams[i]});
            continue;
        }
        int number = 0;
        for (SeamPiece& piece : pieces_of(seams[i])) {
            smooth.push_back({name + ", piece " + std::to_string(number++), std::move(piece.seam)});
        }
    }
    return smooth;
}

}  // namespace

int interpolate_run(const InterpolateRun& given) {
    const std::vector<std::size_t> counts = node_counts(given.nodes);
    const StoredRun run = load_run(given.folder, given.scan);
    std::vector<SeamComparison> comparisons;
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    std::string text;
    int status = run.seams.empty() ? kOutOfTolerance : kPass;
    for (const auto& [name, seam] : smooth_seams(run.seams)) {
        std::cerr << name << ": " << seam.points.size() << " points" << std::flush;
        const MeasuredSeam measured = measure_seam(seam, run.scan, run.config.validate);
        if (measured.p.empty()) {
            throw InputError("interpolate: both flanks of " + name +
                             " are measured nowhere; a scan of both was needed; scan the part again");
        }
        std::cerr << " -> " << measured.p.size() << " places measured" << std::flush;
        comparisons.push_back(compare_methods(seam, measured, counts));
        const Deviation deviation = validate(comparisons.back().best.model, run.scan, run.config.validate);
        status = deviation.pass ? status : kOutOfTolerance;
        std::cerr << "; least rms: " << comparisons.back().best.label << "\n";
        SeamReport report = report_on(comparisons.back(), deviation);
        text += (text.empty() ? "" : "\n") + name + ": " + report.text;
        json.push_back(std::move(report.json));
    }
    if (!given.out.empty() && !comparisons.empty()) {
        write_output(given.out, seam_comparisons_svg(comparisons));
    }
    if (given.json) {
        std::cout << nlohmann::ordered_json{{"seams", json}}.dump(4) << "\n";
    } else {
        std::cout << (text.empty() ? "the run found no seam\n" : text);
    }
    return status;
}

}  // namespace seampath
