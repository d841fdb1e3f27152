// Measures made scans of known truth and prints how far seams and models are from it. Exit status 1 when a limit is
// missed.

#include <cstdio>
#include <iostream>
#include <numeric>

#include <CLI/CLI.hpp>

#include "pipeline/config.hpp"
#include "tests/accuracy/measure.hpp"

namespace {

using namespace seampath;

constexpr const char* kHeader =
    "                                      extracted, mm         fitted, mm            common  apart from that, mm    "
    "     found  false  twice  kind   end    share below   validate          time, s\n"
    "scene                seed   points n  rms    p95    max     rms    p95    max     rms     rms    max     rms    "
    "max    %      %      %      wrong% mm     1sig   2sig   rms    cover  ok  extract  all\n";

/// Of the scenes, those that stand first are fillets and saddles.
constexpr auto kConcave = static_cast<std::ptrdiff_t>(SceneKind::lap);

struct Asked {
    std::vector<std::string> scenes{kSceneNames.begin(), kSceneNames.begin() + kConcave};
    std::uint64_t first_seed = 1;
    int seeds = 5;
    std::string preset = "standard";
    std::vector<std::string> set;
};

/// Worst of every column; 'n' and 'ok' are sums.
Accuracy worst_of(const std::vector<Accuracy>& all) {
    const auto worse = [](Score a, const Score& b) {
        a.rms_mm = std::max(a.rms_mm, b.rms_mm);
        a.p95_mm = std::max(a.p95_mm, b.p95_mm);
        a.max_mm = std::max(a.max_mm, b.max_mm);
        a.found = std::min(a.found, b.found);
        a.false_share = std::max(a.false_share, b.false_share);
        a.repeated_share = std::max(a.repeated_share, b.repeated_share);
        a.wrong_kind_share = std::max(a.wrong_kind_share, b.wrong_kind_share);
        a.end_errors_mm.insert(a.end_errors_mm.end(), b.end_errors_mm.begin(), b.end_errors_mm.end());
        return a;
    };
    return std::accumulate(all.begin() + 1, all.end(), all.front(), [&](Accuracy a, const Accuracy& b) {
        a.points = std::max(a.points, b.points);
        a.seams += b.seams;
        a.passed += b.passed;
        a.extracted = worse(a.extracted, b.extracted);
        a.fitted = worse(a.fitted, b.fitted);
        a.common_mm = std::max(a.common_mm, b.common_mm);
        a.extracted_apart = worse(a.extracted_apart, b.extracted_apart);
        a.fitted_apart = worse(a.fitted_apart, b.fitted_apart);
        a.within_1_sigma = std::min(a.within_1_sigma, b.within_1_sigma);
        a.within_2_sigma = std::min(a.within_2_sigma, b.within_2_sigma);
        a.validated_rms_mm = std::max(a.validated_rms_mm, b.validated_rms_mm);
        a.least_coverage = std::min(a.least_coverage, b.least_coverage);
        a.extract_s = std::max(a.extract_s, b.extract_s);
        a.stages_s = std::max(a.stages_s, b.stages_s);
        return a;
    });
}

void print_row(const std::string& scene, const std::string& seed, const Accuracy& a, const AccuracyLimits& limits) {
    const Score& e = a.extracted;
    const Score& f = a.fitted;
    std::printf(
        "%-20s %4s %8zu %zu  %.4f %.4f %.4f  %.4f %.4f %.4f  %.4f  %.4f %.4f  %.4f %.4f  %6.2f %6.2f %6.2f %6.2f "
        "%6.2f  %.3f  %.3f  %.4f %.3f %zu/%zu  %7.2f %6.2f",
        scene.c_str(), seed.c_str(), a.points, a.seams, e.rms_mm, e.p95_mm, e.max_mm, f.rms_mm, f.p95_mm, f.max_mm,
        a.common_mm, a.extracted_apart.rms_mm, a.extracted_apart.max_mm, a.fitted_apart.rms_mm, a.fitted_apart.max_mm,
        100 * std::min(e.found, f.found), 100 * std::max(e.false_share, f.false_share),
        100 * std::max(e.repeated_share, f.repeated_share), 100 * e.wrong_kind_share,
        std::max(worst_end(e), worst_end(f)), a.within_1_sigma, a.within_2_sigma, a.validated_rms_mm, a.least_coverage,
        a.passed, a.seams, a.extract_s, a.stages_s);
    for (const std::string& miss : missed(a, limits)) {
        std::printf("  * %s", miss.c_str());
    }
    std::printf("\n");
    std::fflush(stdout);
}

std::vector<Accuracy> measure_scene(const Asked& asked, const std::string& scene, const AccuracyLimits& limits) {
    std::vector<Accuracy> all;
    for (int k = 0; k < asked.seeds; ++k) {
        const std::uint64_t seed = asked.first_seed + static_cast<std::uint64_t>(k);
        std::cerr << scene << " seed " << seed << "\n";
        SceneOptions options;
        const auto found = std::find(kSceneNames.begin(), kSceneNames.end(), scene);
        options.kind = static_cast<SceneKind>(found - kSceneNames.begin());
        ScannerOptions scanner = preset(asked.preset);
        ExtractOptions extraction;
        // Corners are looked for only when they are asked for.
        extraction.joint = options.kind == SceneKind::corner ? JointChoice::corner : JointChoice::automatic;
        std::vector<Override> overrides;
        for (const std::string& text : asked.set) {
            overrides.push_back(parse_override(text));
        }
        apply_overrides(
            {{"scene", describe(options)}, {"scanner", describe(scanner)}, {"extract", describe(extraction)}},
            overrides);
        all.push_back(measure_accuracy(make_dataset(options, scanner, seed), extraction));
        print_row(scene, std::to_string(seed), all.back(), limits);
    }
    return all;
}

int run(const Asked& asked) {
    const AccuracyLimits limits;
    std::printf(
        "Limits, for extracted points and for fitted models: rms <= %g mm, max <= %g mm, found >= %g %%, false <= %g "
        "%%, "
        "ends within %g mm. A * names what a row misses.\n"
        "common: what all views that see a flank have in common, no method can see; the errors apart from that "
        "follow.\n"
        "n: seams reported. twice: length reported more than once. ok: models that validate passes. Rows 'worst' hold "
        "the worst of each column, and the sums of n and ok.\n\n%s",
        limits.rms_mm, limits.max_mm, 100 * limits.found, 100 * limits.false_share, limits.end_mm, kHeader);
    std::vector<Accuracy> worst;
    for (const std::string& scene : asked.scenes) {
        worst.push_back(worst_of(measure_scene(asked, scene, limits)));
    }
    std::printf("\n%s", kHeader);
    for (std::size_t i = 0; i < worst.size(); ++i) {
        print_row(asked.scenes[i], "worst", worst[i], limits);
    }
    const Accuracy all = worst_of(worst);
    print_row("all", "worst", all, limits);
    return missed(all, limits).empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures made scans of known truth: how far are seams and models from it?");
    Asked asked;
    app.add_option("--scenes", asked.scenes, "scenes to make; default: those of fillets and saddles")
        ->delimiter(',')
        ->check(CLI::IsMember(std::vector<std::string>(kSceneNames.begin(), kSceneNames.end())));
    app.add_option("--seeds", asked.seeds, "scans of each scene")->check(CLI::PositiveNumber)->capture_default_str();
    app.add_option("--first-seed", asked.first_seed, "seed of the first scan of each scene")->capture_default_str();
    app.add_option("--preset", asked.preset, "scanner")
        ->check(CLI::IsMember(std::vector<std::string>(kPresetNames.begin(), kPresetNames.end())))
        ->capture_default_str();
    app.add_option("--set", asked.set, "scene.key=value, scanner.key=value or extract.key=value")
        ->allow_extra_args(false);
    CLI11_PARSE(app, argc, argv);
    try {
        return run(asked);
    } catch (const std::exception& error) {
        std::cerr << error.what() << "\n";
        return 2;
    }
}
