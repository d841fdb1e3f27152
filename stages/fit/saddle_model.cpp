#include "stages/fit/saddle_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "stages/angle.hpp"
#include "stages/fit/chi_squared.hpp"
#include "stages/geometry/flank_surface.hpp"
#include "stages/geometry/sampled_spline.hpp"
#include "stages/geometry/smoothing.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

constexpr double kLeastTurns = 0.5;   // of the seam about a pipe: less is a bent plate
constexpr double kOutOfRound = 0.02;  // EN 10210-2, EN 10219-2: largest less least diameter, over the nominal one
constexpr double kModelTolerance_mm = 1e-5;

/// Which flank is the branch; the other one is the header.
struct Pipes {
    SurfaceFit branch, header;
    Eigen::MatrixXd between;
    bool branch_first;
};

// How often the points go round an axis.
double turns_about(const Cylinder& cylinder, const std::vector<Vector3d>& points, bool closed) {
    double sum = 0;
    for (std::size_t i = 1; i < points.size() + (closed ? 1 : 0); ++i) {
        const Vector3d a = across(points[i - 1] - cylinder.point, cylinder.axis),
                       b = across(points[i % points.size()] - cylinder.point, cylinder.axis);
        sum += std::atan2(a.cross(b).dot(cylinder.axis), a.dot(b));
    }
    return std::abs(sum) / kTurn;
}

std::variant<Pipes, NoSaddle> pipes_of(const Seam& seam, const Vector3d& origin, const std::vector<Vector3d>& points) {
    const auto& [first, second, between] = seam.surfaces;
    if (!first || !second) {
        return NoSaddle{"a flank was not fitted as one surface"};
    }
    const std::array<SurfaceFit, 2> fits{surface_fit(*first, origin), surface_fit(*second, origin)};
    std::optional<std::size_t> branch;
    bool has_cylinder = false;
    for (const std::size_t k : {0u, 1u}) {
        const auto* cylinder = std::get_if<Cylinder>(&fits[k].shape());
        has_cylinder = has_cylinder || cylinder != nullptr;
        if (cylinder == nullptr || turns_about(*cylinder, points, seam.closed) < kLeastTurns) {
            continue;
        }
        if (!branch || cylinder->radius < std::get<Cylinder>(fits[*branch].shape()).radius) {
            branch = k;
        }
    }
    if (!branch) {
        return NoSaddle{has_cylinder ? "the seam does not go round a pipe" : "neither flank is a cylinder"};
    }
    const Eigen::MatrixXd shared =
        between.empty() ? Eigen::MatrixXd() : matrix_of(between, fits[0].parameters(), fits[1].parameters());
    return *branch == 0 ? Pipes{fits[0], fits[1], shared, true} : Pipes{fits[1], fits[0], shared.transpose(), false};
}

// The stretch of the saddle along the seam's points, from the first one on, and the points' stations on it.
struct Stretch {
    SaddleSeam seam;
    std::vector<double> station;
};

Stretch stretch_of(const SaddleFit& saddle, const std::vector<Vector3d>& points, bool closed) {
    std::vector<double> theta{branch_angle(saddle, points.front())};
    for (std::size_t i = 1; i < points.size(); ++i) {
        theta.push_back(theta.back() + std::remainder(branch_angle(saddle, points[i]) - theta.back(), kTurn));
    }
    const double turn = theta.back() < theta.front() ? -kTurn : kTurn;
    Stretch stretch{SaddleSeam(saddle.curve, theta.front(), closed ? theta.front() + turn : theta.back()), {}};
    for (const double angle : theta) {
        stretch.station.push_back(stretch.seam.station(angle));
    }
    return stretch;
}

double distance(const SurfaceFit::Shape& shape, const Vector3d& p) {
    return std::visit([&](const auto& s) { return signed_distance(s, p); }, shape);
}
Vector3d normal(const SurfaceFit::Shape& shape, const Vector3d& p) {
    return std::visit([&](const auto& s) { return outward_normal(s, p); }, shape);
}

/// What the points are off both walls: of the branch, then of the header, mm.
using Offsets = std::array<std::vector<double>, 2>;

/// Smooth offsets from one wall along the seam.
struct SmoothOffset {
    CubicBSpline line;  ///< its x, over the station
    double freedom = 0;
    double at(double station) const { return position(line, station).x(); }
    double slope(double station) const { return derivative(line, station).x(); }
};

SmoothOffset smoothed(const std::vector<double>& offset, const Stretch& stretch, const std::vector<double>& weight,
                      bool closed) {
    CurvePoints points{{}, stretch.station, weight};
    for (const double o : offset) {
        points.p.emplace_back(o, 0, 0);
    }
    PenalisedSpline spline(breaks_at(points, stretch.seam.length()), closed);
    spline.take(points);
    Smoothing s;
    s.lambda = loose_lambda(points, spline.breaks());
    smooth_evenly(spline, points, s);
    set_level(spline, points, s);
    return {spline.curve(), s.freedom};
}

using SmoothOffsets = std::array<SmoothOffset, 2>;

/// The saddle, or the curve in which its walls meet when they are off by smooth offsets.
class Meeting {
public:
    Meeting(const SaddleFit& saddle, const Stretch& stretch, const std::optional<SmoothOffsets>& offsets)
        : saddle_(saddle), stretch_(stretch), offsets_(offsets) {}

    Vector3d operator()(double station) const {
        const SaddlePoint exact = stretch_.seam.at(station);
        Vector3d p = exact.p;
        for (int round = 0; offsets_ && round < kRounds; ++round) {
            const Vector3d off((*offsets_)[0].at(station) - distance(saddle_.curve.branch(), p),
                               (*offsets_)[1].at(station) - distance(saddle_.header, p),
                               exact.tangent.dot(exact.p - p));
            Eigen::Matrix3d A;
            A << normal(saddle_.curve.branch(), p).transpose(), normal(saddle_.header, p).transpose(),
                exact.tangent.transpose();
            p += A.partialPivLu().solve(off);
        }
        return p;
    }

    /// Of both walls, out of their shapes.
    std::array<Vector3d, 2> normals(double station) const {
        const SaddlePoint exact = stretch_.seam.at(station);
        if (!offsets_) {
            return {exact.n1, exact.n2};
        }
        const Vector3d p = (*this)(station),
                       along = stretch_.seam.backwards() ? Vector3d(-exact.tangent) : exact.tangent;
        return {(normal(saddle_.curve.branch(), p) - (*offsets_)[0].slope(station) * along).normalized(),
                (normal(saddle_.header, p) - (*offsets_)[1].slope(station) * along).normalized()};
    }

private:
    static constexpr int kRounds = 4;  // of Newton's method; offsets are a few hundredths of the radii
    const SaddleFit& saddle_;
    const Stretch& stretch_;
    const std::optional<SmoothOffsets>& offsets_;
};

// Of the points that were measured and are not off from their neighbours: how far they are off the saddle, in their own
// sigmas, in the section across it.
std::vector<Eigen::Vector2d> residuals(const Seam& seam, const Stretch& stretch, const Offsets& offsets,
                                       const std::vector<double>& weight) {
    std::vector<Eigen::Vector2d> z;
    for (std::size_t i = 0; i < weight.size(); ++i) {
        if (weight[i] > 0 && !seam.points[i].modelled) {
            const SaddlePoint exact = stretch.seam.at(stretch.station[i]);
            const double c = exact.n1.dot(exact.n2), s = exact.n1.cross(exact.n2).norm();
            z.push_back(Eigen::Vector2d(offsets[0][i], (offsets[1][i] - c * offsets[0][i]) / s) /
                        seam.points[i].sigma_mm);
        }
    }
    return z;
}

std::string test_in_words(const ChiSquared& test) {
    return "points are " + fixed(std::sqrt(test.per_freedom), 2) +
           " of their sigmas from the exact curve, rms; up to " + fixed(std::sqrt(test.limit), 2) + " is chance with " +
           fixed(test.freedom, 0) + " independent points";
}

/// Within what the walls keep to a round pipe and to the header's shape, mm.
struct Roundness {
    double branch = 0, header = 0;
};

// Of the branch the roundness deviation from the least-squares circle (ISO 12181-1): a shift of the axis and another
// radius do not count.
Roundness roundness_of(const SaddleFit& saddle, const SmoothOffsets& offsets, const Stretch& stretch,
                       const std::vector<Vector3d>& points) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Vector3d b = Vector3d::Zero();
    std::vector<Vector3d> row;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double theta = branch_angle(saddle, points[i]);
        row.emplace_back(1, std::cos(theta), std::sin(theta));
        A += row[i] * row[i].transpose();
        b += offsets[0].at(stretch.station[i]) * row[i];
    }
    const Vector3d circle = A.ldlt().solve(b);
    std::vector<double> branch, header;
    for (std::size_t i = 0; i < points.size(); ++i) {
        branch.push_back(offsets[0].at(stretch.station[i]) - row[i].dot(circle));
        header.push_back(offsets[1].at(stretch.station[i]));
    }
    const auto range = [](const std::vector<double>& values) {
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        return *most - *least;
    };
    return {range(branch), range(header)};
}

SaddleParameters parameters_of(const SaddleFit& saddle) {
    return {static_cast<SurfaceShape>(saddle.header.index()), saddle.branch_radius_mm, saddle.header_radius_mm,
            saddle.angle_rad, saddle.offset_mm};
}

SaddleModel modelled(const SaddleFit& saddle, const Pipes& pipes, const Stretch& stretch,
                     const std::optional<SmoothOffsets>& offsets, CurvePoints& points, bool closed) {
    const Meeting meeting(saddle, stretch, offsets);
    SaddleModel model;
    model.curve = spline_through(meeting, stretch.seam.length(), closed, kModelTolerance_mm).curve;
    model.parameters = parameters_of(saddle);
    model.has_offsets = offsets.has_value();
    model.degrees_of_freedom = pipes.branch.parameters() + pipes.header.parameters();
    if (offsets) {
        model.degrees_of_freedom += (*offsets)[0].freedom + (*offsets)[1].freedom;
    }
    const double branch_side = pipes.branch.bore() ? -1 : 1, header_side = pipes.header.bore() ? -1 : 1;
    for (std::size_t i = 0; i < points.p.size(); ++i) {
        const bool end = !closed && (i == 0 || i + 1 == points.p.size());
        points.u[i] = end ? stretch.station[i] : nearest_parameter(model.curve, points.p[i], stretch.station[i]);
        const auto walls = meeting.normals(points.u[i]);
        const Vector3d branch = branch_side * walls[0], header = header_side * walls[1];
        model.normals.push_back(pipes.branch_first ? std::pair(branch, header) : std::pair(header, branch));
    }
    return model;
}

}  // namespace

std::variant<SaddleModel, NoSaddle> saddle_model(const Seam& seam, const Vector3d& origin, CurvePoints& points,
                                                 const SaddleNominals& nominals, bool exact) {
    const auto pipes = pipes_of(seam, origin, points.p);
    if (const auto* none = std::get_if<NoSaddle>(&pipes)) {
        return *none;
    }
    const auto& [branch, header, between, branch_first] = std::get<Pipes>(pipes);
    const auto fitted = fit_saddle(branch, header, nominals, between);
    if (const auto* none = std::get_if<NoSaddle>(&fitted)) {
        return *none;
    }
    const auto& saddle = std::get<SaddleFit>(fitted);
    if (saddle.nominals > 0 && saddle.nominals_chi2 > saddle.nominals * chi_squared_limit(saddle.nominals)) {
        return NoSaddle{
            "what fit.branch_radius_mm, header_radius_mm, angle_deg and offset_mm say is not what was scanned: "
            "chi-squared " +
            fixed(saddle.nominals_chi2, 1) + " for " + std::to_string(saddle.nominals) +
            (saddle.nominals == 1 ? " number" : " numbers")};
    }
    const Stretch stretch = stretch_of(saddle, points.p, seam.closed);
    Offsets off;
    for (const Vector3d& p : points.p) {
        off[0].push_back(distance(saddle.curve.branch(), p));
        off[1].push_back(distance(saddle.header, p));
    }
    const ChiSquared test = chi_squared(residuals(seam, stretch, off, points.weight), seam.closed);
    const auto result = [&](const std::optional<SmoothOffsets>& offsets, const std::string& reason) {
        SaddleModel model = modelled(saddle, std::get<Pipes>(pipes), stretch, offsets, points, seam.closed);
        model.reason = reason + "; " + test_in_words(test);
        return model;
    };
    if (test.holds()) {
        return result(std::nullopt, "the pipe is round");
    }
    const SmoothOffsets offsets{smoothed(off[0], stretch, points.weight, seam.closed),
                                smoothed(off[1], stretch, points.weight, seam.closed)};
    const Roundness roundness = roundness_of(saddle, offsets, stretch, points.p);
    const std::string off_by = "the branch is out of round by " + fixed(roundness.branch, 3) +
                               " mm, the header's wall off a " +
                               std::string(name(static_cast<SurfaceShape>(saddle.header.index()))) + " by " +
                               fixed(roundness.header, 3) + " mm";
    const double most = kOutOfRound * saddle.branch_radius_mm.value;
    if (std::max(roundness.branch, roundness.header) > most) {
        return NoSaddle{off_by + ", more than the " + fixed(most, 3) + " mm that a pipe of this size may be"};
    }
    return exact ? result(std::nullopt, "fit.model asks for it, though " + off_by) : result(offsets, off_by);
}

}  // namespace seampath
