#include "stages/plan/passes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/sampled_spline.hpp"
#include "stages/plan/text.hpp"

namespace seampath::planning {
namespace {

using Eigen::Vector3d;

// Sections between a knife's edge and a plane.
constexpr double kLeastHalf = 2 * kDegree, kMostHalf = 80 * kDegree;

constexpr std::size_t kMostPasses = 500;

// Stations at which the section is looked at.
constexpr int kGrooveLooks = 400;

// What a pass's curve may be off, as a share of the chord tolerance.
constexpr double kCurveShare = 0.05;

// Least cosine between a pass and the seam below it: the pass goes on where the seam does.
constexpr double kLeastCosine = 0.2;

/// The groove's section at one station.
struct Section {
    Vector3d p, x;        // of the seam, mm, and travel
    Vector3d up, across;  // along the groove's middle, and towards flank 1
    double turn = 0;      // of `up` from the flanks' bisector, towards flank 1, rad
    double half = 0;      // phi
    double root = 0;      // b
    FlankSample flanks;

    double width(double y) const { return root + 2 * y * std::tan(half); }
    double area(double y) const { return y * (root + y * std::tan(half)); }
    double height(double area) const {
        return area > 0 ? 2 * area / (root + std::sqrt(root * root + 4 * area * std::tan(half))) : 0;
    }
};

class Groove {
public:
    Groove(const SeamModel& model, int seam, const PlanOptions& o)
        : model_(model), arc_(model.curve), seam_(seam), o_(o) {}

    double length() const { return arc_.length(); }

    Section at(double station) const {
        Section s;
        const bool last = !model_.closed && station >= arc_.length();
        const double u = last ? last_parameter(arc_.curve()) : arc_.parameter(station);
        s.flanks = flanks_at(model_, station);
        s.p = position(arc_.curve(), u);
        s.x = tangent(arc_.curve(), u);
        const Vector3d sum = s.flanks.n1 + s.flanks.n2, bisector = sum - sum.dot(s.x) * s.x;
        const double opening =
            std::numbers::pi - std::atan2(s.flanks.n1.cross(s.flanks.n2).norm(), s.flanks.n1.dot(s.flanks.n2));
        const double asked = o_.groove_angle_deg * kDegree;
        s.root = o_.groove_root_mm;
        s.half = o_.groove == GrooveForm::fillet ? 0.5 * opening : 0.5 * asked;
        s.turn = o_.groove == GrooveForm::bevel1   ? 0.5 * (asked - opening)
                 : o_.groove == GrooveForm::bevel2 ? 0.5 * (opening - asked)
                                                   : 0;
        if (!(bisector.norm() > 0.05) || s.half < kLeastHalf || s.half > kMostHalf) {
            throw InputError(seam_text(seam_) + ": at station " + number(station) + " mm the groove opens by " +
                             number(2 * s.half / kDegree) + " deg; " + number(2 * kLeastHalf / kDegree) + " to " +
                             number(2 * kMostHalf / kDegree) +
                             " deg can be filled; set plan.groove to another form or to none");
        }
        const Vector3d middle = bisector.normalized();
        const Eigen::AngleAxisd lean(s.turn, s.x);
        s.up = lean * middle;
        s.across = s.x.cross(s.up);
        return s;
    }

private:
    const SeamModel& model_;
    ArcLength arc_;
    int seam_;
    const PlanOptions& o_;
};

/// Beads of each layer, from the root up.
std::vector<int> layers_of(const Section& mean, const PlanOptions& o, int seam) {
    const double a = o.bead_area_mm2, t = std::sqrt(a / o.bead_width_to_height), w = a / t;
    std::vector<int> beads;
    double y = 0, below = 0;
    std::size_t passes = 0;
    while (beads.empty() || o.groove_depth_mm - y > 0.5 * t) {
        beads.push_back(std::max(1, static_cast<int>(std::lround(mean.width(y + 0.5 * t) / w))));
        below = mean.area(y);
        y = mean.height(below + beads.back() * a);
        passes += static_cast<std::size_t>(beads.back());
        if (passes > kMostPasses) {
            throw InputError(seam_text(seam) + ": a groove of " + number(mean.area(o.groove_depth_mm)) +
                             " mm2 would take more than " + std::to_string(kMostPasses) +
                             " beads of plan.bead_area_mm2 = " + number(a) +
                             "; a larger bead or a smaller plan.groove_depth_mm is needed");
        }
    }
    beads.back() = std::max(1, static_cast<int>(std::lround((mean.area(o.groove_depth_mm) - below) / a)));
    // Two beads can't lie beside each other on an edge.
    if (beads.size() == 1 && beads.back() > 1 && mean.root < w) {
        beads = {1, beads.back() - 1};
    }
    return beads;
}

/// A bead in its layer: which one of how many from the side of flank 1, and what lies below its layer.
struct Bead {
    int layer, place, of;
    double below;  // share of the section's area
};

/// Aim and lean of a bead in a section.
struct Aim {
    double across, up, tilt;
};
Aim aim_of(const Section& s, const Bead& bead, const PlanOptions& o) {
    const double y = s.height(bead.below * s.area(o.groove_depth_mm));
    const double share = 1 - (2.0 * bead.place + 1) / bead.of;  // of half the width: towards flank 1
    const double most = std::min(o.pass_tilt_deg * kDegree, s.half);
    const double side = bead.of > 1 ? share * bead.of / (bead.of - 1) : 0;  // 1 at the side of flank 1
    return {0.5 * share * s.width(y), y, -most * side};
}

/// Beads in the order of welding.
std::vector<Bead> beads_of(const std::vector<int>& layers, PassOrder order) {
    double all = 0;
    for (const int beads : layers) {
        all += beads;
    }
    std::vector<Bead> result;
    double below = 0;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        const bool from_first = order == PassOrder::flank1 || (order == PassOrder::alternate && k % 2 == 0);
        for (int i = 0; i < layers[k]; ++i) {
            result.push_back({static_cast<int>(k), from_first ? i : layers[k] - 1 - i, layers[k], below / all});
        }
        below += layers[k];
    }
    return result;
}

SeamModel model_of(const SeamModel& seam, int number_of_seam, const Groove& groove, const Bead& bead,
                   const PlanOptions& o) {
    const auto at = [&](double station) -> Vector3d {
        const Section s = groove.at(station);
        const Aim aim = aim_of(s, bead, o);
        return s.p + aim.across * s.across + aim.up * s.up;
    };
    SeamModel model = seam;
    model.curve = spline_through(at, groove.length(), seam.closed, kCurveShare * o.chord_tolerance_mm).curve;
    const ArcLength arc(model.curve);
    model.length_mm = arc.length();
    model.flanks.clear();
    std::vector<double> stations;
    for (const FlankSample& flank : seam.flanks) {
        stations.push_back(flank.station_mm);
    }
    for (int k = 0; k <= kGrooveLooks - (seam.closed ? 1 : 0); ++k) {
        stations.push_back(groove.length() * k / kGrooveLooks);
    }
    std::sort(stations.begin(), stations.end());
    for (const double station : stations) {
        const Section s = groove.at(station);
        if (tangent(model.curve, station).dot(s.x) < kLeastCosine) {
            const Aim aim = aim_of(s, bead, o);
            throw InputError(seam_text(number_of_seam) + ": at station " + number(station) + " mm a pass " +
                             number(std::hypot(aim.across, aim.up)) +
                             " mm off the seam folds back, for the seam bends to that side; a smaller "
                             "plan.groove_depth_mm is needed");
        }
        const Eigen::AngleAxisd lean(s.turn + aim_of(s, bead, o).tilt, s.x);
        FlankSample flank = s.flanks;
        flank.station_mm = arc.station(station);
        flank.n1 = lean * flank.n1;
        flank.n2 = lean * flank.n2;
        if (model.flanks.empty() || flank.station_mm > model.flanks.back().station_mm) {
            model.flanks.push_back(flank);
        }
    }
    return model;
}

}  // namespace

std::vector<Pass> passes_of(const SeamModel& model, int seam, const PlanOptions& o) {
    const Groove groove(model, seam, o);
    std::vector<Section> sections;
    Section mean;
    for (int k = 0; k < kGrooveLooks; ++k) {
        sections.push_back(groove.at(groove.length() * (k + 0.5) / kGrooveLooks));
        mean.half += std::tan(sections.back().half) / kGrooveLooks;
    }
    mean.half = std::atan(mean.half);
    mean.root = o.groove_root_mm;
    const std::vector<Bead> beads = beads_of(layers_of(mean, o, seam), o.pass_order);
    std::vector<Pass> passes;
    for (const Bead& bead : beads) {
        Pass pass{model_of(model, seam, groove, bead, o), {}};
        PlannedPass& f = pass.facts;
        f.seam = seam;
        f.layer = bead.layer;
        f.bead = static_cast<int>(
            std::count_if(passes.begin(), passes.end(), [&](const Pass& p) { return p.facts.layer == bead.layer; }));
        const auto share = static_cast<double>(beads.size());
        f.least_mm2 = f.most_mm2 = sections.front().area(o.groove_depth_mm) / share;
        for (const Section& s : sections) {
            const Aim aim = aim_of(s, bead, o);
            const double area = s.area(o.groove_depth_mm) / share;
            f.across_mm += aim.across / kGrooveLooks;
            f.up_mm += aim.up / kGrooveLooks;
            f.tilt_rad += aim.tilt / kGrooveLooks;
            f.area_mm2 += area / kGrooveLooks;
            f.least_mm2 = std::min(f.least_mm2, area);
            f.most_mm2 = std::max(f.most_mm2, area);
        }
        passes.push_back(std::move(pass));
    }
    return passes;
}

}  // namespace seampath::planning
