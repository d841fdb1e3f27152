#include "tests/accuracy/joint_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/text.hpp"

namespace seampath {
namespace {

constexpr JointLimits kFine{{{0.010, 0.030}}, {}, 0.99, 0.0};
constexpr JointLimits kWavy{{{0.025, 0.080}}, {}, 0.98, 0.0};
constexpr JointLimits kGroove{{{0.025, 0.080}}, {{0.060, 0.150}}, 0.98, 0.0};
constexpr JointLimits kHonest{};  // nothing but that no seam that passes is wrong
constexpr JointLimits kSigma{{}, {}, 0, {}, true};

SceneOptions scene(SceneKind kind, Course course = Course::straight) {
    SceneOptions o;
    o.kind = kind;
    o.course = course;
    return o;
}

SceneOptions butt(Course course) {
    SceneOptions o = scene(SceneKind::butt, course);
    o.gap_mm = 0.9;
    return o;
}

/// Noise and registration as asked; the distance of points is the preset's.
ScannerOptions usual_scanner() {
    ScannerOptions o;
    o.sigma_mm = 0.04;
    o.registration_mm = 0.015;
    return o;
}

/// What a preset's scans must reach: half of its noise and its systematic errors, as the makers state them.
struct PresetRow {
    const char* preset;
    double systematic_mm;
    double size;  ///< as many points as before other scanners
};
constexpr std::array<PresetRow, 4> kPresetRows{{{"phoxi_s", 0.22, 0.5},
                                                {"zivid2p_m60", 0.10, 0.7},
                                                {"gocator2440_robot", 0.018 + 0.05, 0.25},
                                                {"ljx8200_robot", 0.05, 0.25}}};
constexpr std::array kPresetScenes{SceneKind::tee,  SceneKind::pipe_on_plate, SceneKind::lap,
                                   SceneKind::butt, SceneKind::v_groove,      SceneKind::corner};

SceneOptions resized(const SceneOptions& scene, double size, std::uint64_t seed) {
    SceneOptions o = resolved(scene, seed);
    const auto thickness = o.plate_thickness_mm, margin = o.margin_mm;
    for (std::optional<double> SceneOptions::*extent :
         {&SceneOptions::length_mm, &SceneOptions::width_mm, &SceneOptions::height_mm, &SceneOptions::amplitude_mm,
          &SceneOptions::wavelength_mm, &SceneOptions::corner_radius_mm, &SceneOptions::header_radius_mm,
          &SceneOptions::header_length_mm, &SceneOptions::radius_mm, &SceneOptions::offset_mm,
          &SceneOptions::course_radius_mm, &SceneOptions::overlap_mm, &SceneOptions::margin_mm,
          &SceneOptions::thickness_mm, &SceneOptions::plate_thickness_mm}) {
        if (o.*extent) {
            *(o.*extent) *= size;
        }
    }
    if (o.kind == SceneKind::v_groove) {  // which is as deep as ever, and needs tops beside it
        o.plate_thickness_mm = thickness;
        o.margin_mm = std::max(0.6, size) * *margin;
    }
    if (o.kind == SceneKind::lap) {
        constexpr double kSheet = 1.5;  // mm; what is thinner is taken for a machined step
        o.thickness_mm = std::max(kSheet, *o.thickness_mm);
    }
    return o;
}

void count_parameter(const std::optional<Measured>& measured, const std::optional<double>& truth, JointResult& r) {
    if (measured && truth) {
        const double off = std::abs(measured->value - *truth);
        ++r.parameters;
        r.parameters_1_sigma += off < measured->sigma;
        r.parameters_2_sigma += off < 2 * measured->sigma;
    }
}

void count_parameters(const Accuracy& a, const SceneOptions& made, JointResult& r) {
    const bool on_pipe = made.kind == SceneKind::pipe_on_pipe || made.kind == SceneKind::pipe_on_pipe_oblique ||
                         made.kind == SceneKind::pipe_on_pipe_equal;
    for (const SaddleParameters& saddle : a.saddles) {
        count_parameter(saddle.branch_radius_mm, made.radius_mm, r);
        const double lean = std::numbers::pi / 180 * made.lean_deg.value_or(0);
        count_parameter(saddle.angle_rad, std::numbers::pi / 2 - lean, r);
        if (on_pipe) {
            count_parameter(saddle.header_radius_mm, made.header_radius_mm, r);
            count_parameter(saddle.offset_mm, made.offset_mm, r);
        }
    }
}

void add(const Accuracy& a, JointResult& r) {
    const double n = ++r.scans;
    const auto mean_with = [n](double mean, double x) { return mean + (x - mean) / n; };
    r.seams += a.seams;
    r.passed += a.passed;
    r.wrong += a.passed_wrong;
    r.all_rms_mm = std::sqrt(mean_with(r.all_rms_mm * r.all_rms_mm, a.fitted.rms_mm * a.fitted.rms_mm));
    r.common_mm = std::sqrt(mean_with(r.common_mm * r.common_mm, a.common_mm * a.common_mm));
    const double apart = a.fitted_apart.rms_mm;
    r.apart_mm = std::sqrt(mean_with(r.apart_mm * r.apart_mm, apart * apart));
    r.rms_mm = std::max(r.rms_mm, a.fitted.rms_mm);
    r.max_mm = std::max(r.max_mm, a.fitted.max_mm);
    r.across_rms_mm = std::max(r.across_rms_mm, a.fitted.lateral_rms_mm);
    r.across_max_mm = std::max(r.across_max_mm, a.fitted.lateral_max_mm);
    r.depth_rms_mm = std::max(r.depth_rms_mm, a.fitted.vertical_rms_mm);
    r.depth_max_mm = std::max(r.depth_max_mm, a.fitted.vertical_max_mm);
    r.found = std::min(r.found, a.fitted.found);
    r.false_share = std::max(r.false_share, a.fitted.false_share);
    r.within_1_sigma = mean_with(r.within_1_sigma, a.within_1_sigma);
    r.within_2_sigma = mean_with(r.within_2_sigma, a.within_2_sigma);
}

}  // namespace

std::vector<JointRow> joint_rows() {
    const ScannerOptions usual = usual_scanner();
    std::vector<JointRow> rows;
    for (const SceneKind kind :
         {SceneKind::tee, SceneKind::box_on_plate, SceneKind::pipe_on_plate, SceneKind::corner, SceneKind::pipe_on_pipe,
          SceneKind::pipe_on_pipe_oblique, SceneKind::pipe_on_pipe_equal}) {
        rows.push_back({std::string(name(kind)), scene(kind), usual, 1, 1, kFine});
    }
    rows.push_back({"s-curve", scene(SceneKind::s_curve), usual, 1, 1, kWavy});
    rows.push_back({"lap on an s-curve", scene(SceneKind::lap, Course::s_curve), usual, 1, 1, kWavy});
    rows.push_back({"butt, gap 0.9", butt(Course::straight), usual, 1, 1, kWavy});
    rows.push_back({"butt on an arc", butt(Course::arc), usual, 1, 1, kWavy});
    rows.push_back({"v-groove", scene(SceneKind::v_groove), usual, 1, 1, kGroove});
    rows.push_back({"v-groove on an arc", scene(SceneKind::v_groove, Course::arc), usual, 1, 1, kGroove});
    for (const PresetRow& of : kPresetRows) {
        const ScannerOptions scanner = preset(of.preset);
        const double rms = 0.5 * scanner.sigma_mm + of.systematic_mm;
        for (const SceneKind kind : kPresetScenes) {
            rows.push_back({std::string(of.preset) + ", " + std::string(name(kind)),
                            scene(kind),
                            scanner,
                            of.size,
                            1,
                            {{{rms, kCorrespondence}}, {}, 0.97, 0.01}});
        }
    }
    for (const char* stress : {"rgbd", "worst"}) {
        for (const SceneKind kind : kPresetScenes) {
            rows.push_back(
                {std::string(stress) + ", " + std::string(name(kind)), scene(kind), preset(stress), 1, 1, kHonest});
        }
    }
    constexpr int kScans = 40;
    rows.push_back({"sigma, fillet", scene(SceneKind::tee), usual, 0.4, kScans, kSigma});
    rows.push_back({"sigma, saddle", scene(SceneKind::pipe_on_pipe), usual, 0.4, kScans, kSigma});
    rows.push_back({"sigma, v-groove", scene(SceneKind::v_groove), usual, 0.4, kScans, kSigma});
    rows.push_back({"sigma, lap", scene(SceneKind::lap), usual, 0.4, kScans, kSigma});
    return rows;
}

JointResult measure_row(const JointRow& row, std::uint64_t first_seed, int scans) {
    JointResult result;
    ExtractOptions extraction;
    // Corners are looked for only when they are asked for.
    extraction.joint = row.scene.kind == SceneKind::corner ? JointChoice::corner : JointChoice::automatic;
    for (int k = 0; k < scans; ++k) {
        const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(k);
        const SceneOptions made = resized(row.scene, row.size, seed);
        const Accuracy a = measure_accuracy(make_dataset(made, row.scanner, seed), extraction);
        add(a, result);
        count_parameters(a, made, result);
    }
    return result;
}

std::vector<std::string> missed(const JointResult& r, const JointLimits& asked) {
    std::vector<std::string> misses;
    const auto at_most = [&](const std::string& what, double value, double limit) {
        if (!(value <= limit)) {
            misses.push_back(what + " " + fixed(value, 4) + " > " + fixed(limit, 3));
        }
    };
    const auto within = [&](const std::string& what, double value, double low, double high) {
        if (!(value >= low && value <= high)) {
            misses.push_back(what + " " + fixed(value, 3) + " not in " + fixed(low, 2) + " to " + fixed(high, 2));
        }
    };
    const auto shares = [&](const std::string& of, double one, double two) {
        within(of + " within 1 sigma", one, 0.60, 0.76);
        within(of + " within 2 sigma", two, 0.92, 0.98);
    };
    if (asked.off) {
        at_most("rms", asked.depth ? r.across_rms_mm : r.rms_mm, asked.off->rms_mm);
        at_most("max", asked.depth ? r.across_max_mm : r.max_mm, asked.off->max_mm);
    }
    if (asked.depth) {
        at_most("depth rms", r.depth_rms_mm, asked.depth->rms_mm);
        at_most("depth max", r.depth_max_mm, asked.depth->max_mm);
    }
    at_most("not found", 1 - r.found, 1 - asked.found);
    if (asked.false_share) {
        at_most("false", r.false_share, *asked.false_share);
    }
    if (r.wrong > 0) {
        misses.push_back(std::to_string(r.wrong) + " passed and wrong");
    }
    if (asked.sigma) {
        shares("points", r.within_1_sigma, r.within_2_sigma);
    }
    if (asked.sigma && r.parameters > 0) {
        const auto all = static_cast<double>(r.parameters);
        shares("parameters", static_cast<double>(r.parameters_1_sigma) / all,
               static_cast<double>(r.parameters_2_sigma) / all);
    }
    return misses;
}

}  // namespace seampath
