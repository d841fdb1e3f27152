#include <algorithm>

#include "stages/error.hpp"
#include "stages/extract/extract.hpp"
#include "stages/text.hpp"
#include "tests/accuracy/measure.hpp"
#include "tests/papers/sections.hpp"
#include "tools/interpolation_seams.hpp"

namespace seampath {
namespace {

using Rows = std::vector<std::vector<std::string>>;

constexpr std::array<std::size_t, 3> kNodes{8, 16, 24};
constexpr int kDecimals = 3;
constexpr double kSigma_mm = 0.03, kPitch_mm = 0.6;

/// A part small enough for many scans.
SceneOptions small_part(SceneKind kind) {
    SceneOptions scene;
    scene.kind = kind;
    scene.vary = false;
    scene.margin_mm = 11;
    scene.plate_thickness_mm = 4;
    scene.height_mm = 12;
    scene.length_mm = kind == SceneKind::tee ? 40 : kind == SceneKind::s_curve ? 75 : 36;
    scene.width_mm = 26;
    scene.corner_radius_mm = 6;
    scene.amplitude_mm = 7;
    scene.wavelength_mm = 50;
    scene.header_radius_mm = 24;
    scene.radius_mm = kind == SceneKind::pipe_on_plate ? 15 : 17;
    return scene;
}

struct ScannedSeam {
    std::string name;
    SeamComparison comparison;
};

/// The longest seam of each part.
std::vector<ScannedSeam> scanned_seams() {
    ScannerOptions scanner;
    scanner.sigma_mm = kSigma_mm;
    scanner.pitch_x_mm = scanner.pitch_y_mm = kPitch_mm;
    std::vector<ScannedSeam> all;
    for (const SceneKind kind : {SceneKind::tee, SceneKind::s_curve, SceneKind::box_on_plate, SceneKind::pipe_on_plate,
                                 SceneKind::pipe_on_pipe}) {
        const Scan scan = scan_of(make_dataset(small_part(kind), scanner, 1));
        const Extraction found = extract(scan, {});
        ensure(!found.seams.empty(), "the page's scans have seams");
        const Seam& seam = found.seams.front();
        all.push_back({std::string(name(kind)), compare_methods(seam, measure_seam(seam, scan, {}), kNodes)});
    }
    return all;
}

using Part = SeamRanking SeamComparison::*;

/// The seams' methods, in the order of the options.
std::vector<SeamMethod> methods_of(const std::vector<ScannedSeam>& seams, Part part) {
    std::vector<SeamMethod> all;
    for (const ScannedSeam& seam : seams) {
        const auto& methods = (seam.comparison.*part).methods;
        all.insert(all.end(), methods.begin(), methods.end());
    }
    const auto key = [](const SeamMethod& m) { return std::pair(m.options.model, m.options.parametrization); };
    std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    const auto same = [&](const auto& a, const auto& b) { return key(a) == key(b); };
    all.erase(std::unique(all.begin(), all.end(), same), all.end());
    return all;
}

const SeamMethod* find(const SeamRanking& ranking, const std::string& label) {
    const auto found = std::find_if(ranking.methods.begin(), ranking.methods.end(),
                                    [&](const auto& method) { return method.label == label; });
    return found == ranking.methods.end() ? nullptr : &*found;
}

/// Methods as rows; what prints like the best of its seam is in bold type.
std::string mean_table(const std::vector<ScannedSeam>& seams, Part part) {
    Rows rows{{"mean rms, mm"}};
    for (const ScannedSeam& seam : seams) {
        rows[0].push_back(seam.name);
    }
    for (const SeamMethod& method : methods_of(seams, part)) {
        rows.push_back({method.label});
        for (const ScannedSeam& seam : seams) {
            const SeamRanking& ranking = seam.comparison.*part;
            const SeamMethod* found = find(ranking, method.label);
            const std::string text = found ? fixed(found->mean_rms_mm, kDecimals) : "–";
            const bool best = text == fixed(ranking.methods.front().mean_rms_mm, kDecimals);
            rows.back().push_back(best ? "**" + text + "**" : text);
        }
    }
    rows.push_back({"spline through all points"});
    for (const ScannedSeam& seam : seams) {
        rows.back().push_back(fixed(seam.comparison.spline.rms_mm, kDecimals));
    }
    return markdown_table(rows);
}

/// Name, rms and largest distance of the method of least rms with one number of nodes. Of two names of one line, which
/// only rounding tells apart, the first in the alphabet.
std::vector<std::string> best_cells(const SeamRanking& ranking, std::size_t k) {
    constexpr double kRounding_mm = 1e-9;
    const auto& methods = ranking.methods;
    const auto rms = [k](const SeamMethod& m) { return m.trials[k].rms_mm; };
    const double least = rms(*std::ranges::min_element(methods, {}, rms));
    const SeamMethod* best = nullptr;
    for (const SeamMethod& method : methods) {
        if (rms(method) <= least + kRounding_mm && (best == nullptr || method.label < best->label)) {
            best = &method;
        }
    }
    return {best->label, fixed(rms(*best), kDecimals), fixed(best->trials[k].max_mm, kDecimals)};
}

std::string best_table(const std::vector<ScannedSeam>& seams) {
    Rows rows{
        {"seam", "nodes", "best, equally spaced", "rms", "largest", "nodes", "best, by curvature", "rms", "largest"}};
    for (const ScannedSeam& seam : seams) {
        for (std::size_t k = 0; k < kNodes.size(); ++k) {
            const SeamRanking &equal = seam.comparison.equal, &curvature = seam.comparison.curvature;
            rows.push_back({k == 0 ? seam.name + (seam.comparison.closed ? ", closed, " : ", ") +
                                         fixed(seam.comparison.length_mm, 0) + " mm"
                                   : "",
                            std::to_string(equal.counts[k])});
            const auto left = best_cells(equal, k), right = best_cells(curvature, k);
            rows.back().insert(rows.back().end(), left.begin(), left.end());
            rows.back().push_back(std::to_string(curvature.counts[k]));
            rows.back().insert(rows.back().end(), right.begin(), right.end());
        }
    }
    return markdown_table(rows);
}

/// On how many seams a method beats another with nodes placed by curvature.
std::string wins(const std::vector<ScannedSeam>& seams, const std::string& a, const std::string& b) {
    int wins = 0, both = 0;
    for (const ScannedSeam& seam : seams) {
        const SeamMethod *first = find(seam.comparison.curvature, a), *second = find(seam.comparison.curvature, b);
        both += first && second ? 1 : 0;
        wins += first && second && first->mean_rms_mm < second->mean_rms_mm ? 1 : 0;
    }
    return std::to_string(wins) + " of " + std::to_string(both);
}

}  // namespace

std::string scanned_section() {
    const std::vector<ScannedSeam> seams = scanned_seams();
    return "## The same on scanned seams\n\n"
           "Minejeva and Markovics rank methods on two tables. Here they are laid through the seams of five scans "
           "(noise " +
           fixed(kSigma_mm, 2) + " mm, points " + fixed(kPitch_mm, 1) +
           " mm apart in each view). Nodes are points of the extracted seam; the lines are held against the places in "
           "which the flanks of the raw scan meet. Any scan of your own is measured in the same way:\n\n"
           "    build/seampath run part.ply --out out/part\n"
           "    build/seampath interpolate out/part --nodes 8,16,24 --out out/methods.svg\n"
           "    build/seampath run part.ply --out out/part --set fit.model=akima\n\n"
           "Nodes equally spaced, as the paper's formulas ask for; geometric mean over 8, 16 and 24 nodes:\n\n" +
           mean_table(seams, &SeamComparison::equal) +
           "As many nodes where the seam bends, as stage `place` sets them:\n\n" +
           mean_table(seams, &SeamComparison::curvature) +
           "Bold: the best of its seam, to the digits shown. A dash: the method can't serve the seam, for it has ends "
           "and the "
           "seam has none, or the other way round. Stirling's line jumps midway between two nodes; here the formulas "
           "about both nodes count, each the more the nearer its node is. Divided differences give Lagrange's line. "
           "With nodes by curvature, Marin's (31) is nearer than chord length on " +
           wins(seams, "parametric (exact)", "parametric (chord)") +
           " seams, and Akima's line nearer than the parametric spline over chord length on " +
           wins(seams, "akima", "parametric (chord)") +
           ". The spline through all points is what `fit.model` takes by default where a seam goes round no pipe: it "
           "averages the noise that an interpolating line passes on.\n\n" +
           best_table(seams);
}

}  // namespace seampath
