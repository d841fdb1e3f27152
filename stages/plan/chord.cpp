#include "stages/plan/chord.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"

namespace seampath::planning {
namespace {

// What may lie between two samples, as a share of the chord tolerance: gives 16 samples under a chord that just holds
// it.
constexpr double kSampleShare = 1.0 / 256;

// A flank sample so near to a piece's end, as a share of the piece, is there already.
constexpr double kSamePlace = 1e-6;

// Where the pieces of c begin and end, and c'' is linear in between.
std::vector<double> span_ends(const CubicBSpline& curve) {
    std::vector<double> ends;
    const double first = first_parameter(curve), last = last_parameter(curve);
    for (const double knot : curve.knots) {
        if (knot >= first && knot <= last && (ends.empty() || knot > ends.back())) {
            ends.push_back(knot);
        }
    }
    return ends;
}

// Parameters of the model's flank samples, between which the flanks turn evenly.
std::vector<double> flank_parameters(const TorchPath& path) {
    std::vector<double> parameters;
    for (const FlankSample& flank : path.model().flanks) {
        parameters.push_back(path.arc().parameter(flank.station_mm));
    }
    std::sort(parameters.begin(), parameters.end());
    return parameters;
}

}  // namespace

Samples sample(const TorchPath& path, double tolerance_mm) {
    const CubicBSpline& curve = path.arc().curve();
    const std::vector<double> ends = span_ends(curve), flanks = flank_parameters(path);
    Samples samples;
    samples.pose.push_back(path.at_parameter(ends.front()));
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
        const double from = ends[k], span = ends[k + 1] - from;
        const Eigen::Vector3d quarter = second_derivative(curve, from + 0.25 * span);
        const Eigen::Vector3d three_quarters = second_derivative(curve, from + 0.75 * span);
        const double bend =
            std::max((1.5 * quarter - 0.5 * three_quarters).norm(), (1.5 * three_quarters - 0.5 * quarter).norm());
        ensure(std::isfinite(bend), "a model's curve is finite");
        const int pieces =
            std::max(2, static_cast<int>(std::ceil(span * std::sqrt(bend / (8 * kSampleShare * tolerance_mm)))));
        const double step = span / pieces;
        std::vector<double> u;
        for (int piece = 1; piece <= pieces; ++piece) {
            u.push_back(piece == pieces ? ends[k + 1] : from + piece * step);
        }
        const auto last = std::lower_bound(flanks.begin(), flanks.end(), ends[k + 1]);
        std::copy_if(std::upper_bound(flanks.begin(), flanks.end(), from), last, std::back_inserter(u),
                     [&](double flank) {
                         const double piece = (flank - from) / step;
                         return std::abs(piece - std::round(piece)) > kSamePlace;
                     });
        std::sort(u.begin(), u.end());
        for (const double at : u) {
            samples.pose.push_back(path.at_parameter(at));
            samples.bulge_mm.push_back(bend * step * step / 8);
        }
    }
    return samples;
}

Chord chord(const Samples& samples, const TorchPose& a, const TorchPose& b) {
    const auto by_parameter = [](double u, const TorchPose& pose) { return u < pose.u; };
    auto k = std::upper_bound(samples.pose.begin(), samples.pose.end(), a.u, by_parameter) - samples.pose.begin();
    Chord result{0, rotation_angle(a.q, b.q)};
    // Of the piece after sample i. There is none after the last one, which a parameter may pass by rounding.
    const auto bulge_after = [&](std::ptrdiff_t i) {
        return i < std::ssize(samples.bulge_mm) ? samples.bulge_mm[i] : 0;
    };
    double bulge = k > 0 && a.u < b.u ? bulge_after(k - 1) : 0;
    for (; k < std::ssize(samples.pose) && samples.pose[k].u < b.u; ++k) {
        const TorchPose& s = samples.pose[k];
        result.error_mm = std::max(result.error_mm, distance_to_segment(s.p, a.p, b.p));
        result.turn = std::max({result.turn, rotation_angle(a.q, s.q), rotation_angle(s.q, b.q)});
        bulge = std::max(bulge, bulge_after(k));
    }
    result.error_mm += bulge;
    return result;
}

}  // namespace seampath::planning
