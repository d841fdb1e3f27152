#include "tests/report/example_part.hpp"

#include <cmath>
#include <numbers>

#include "stages/geometry/bspline.hpp"

namespace seampath::test {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 30, kPlate = 75, kPipeHeight = 55, kRibY = -52, kRibHeight = 25, kRibFrom = -60, kRibTo = 60;
const Vector3d kOrigin(1200, -350, 480);

/// Noise of +-0.05 mm that needs no generator.
double ripple(std::size_t i) {
    return 0.05 * std::sin(12.9898 * static_cast<double>(i) + 78.233);
}

Scan example_scan() {
    Scan scan;
    scan.name = "pipe & plate <1>";
    scan.origin_mm = kOrigin;
    scan.format = "ply binary_little_endian";
    scan.unit_reason = "the largest extent is 150, which is 20 or more, so the file is in mm";
    const auto add = [&](double x, double y, double z) { scan.points.emplace_back(Vector3d(x, y, z).cast<float>()); };
    for (double x = -kPlate; x <= kPlate; x += 0.45) {
        for (double y = -kPlate; y <= kPlate; y += 0.45) {
            if (std::hypot(x, y) > kRadius && !(y < kRibY - 0.5 && y > kRibY - 5.5 && x > kRibFrom && x < kRibTo)) {
                add(x, y, ripple(scan.points.size()));
            }
        }
    }
    for (double z = 0.3; z < kPipeHeight; z += 0.45) {
        for (double t = 0; t < 2 * kPi; t += 0.45 / kRadius) {
            const double r = kRadius + ripple(scan.points.size());
            add(r * std::cos(t), r * std::sin(t), z);
        }
    }
    for (double x = kRibFrom; x < kRibTo; x += 0.45) {
        for (double z = 0.3; z < kRibHeight; z += 0.45) {
            add(x, kRibY + ripple(scan.points.size()), z);
        }
        for (double y = kRibY - 5; y < kRibY; y += 0.45) {
            add(x, y, kRibHeight + ripple(scan.points.size()));
        }
    }
    scan.points_in_file = scan.points.size() + 17;
    scan.dropped_not_finite = 17;
    return scan;
}

struct CurvePoint {
    Vector3d p, n1, n2;
};

/// The pipe's foot: flank 1 is the plate, flank 2 the pipe, so n1 x n2 is the counter-clockwise tangent.
CurvePoint on_circle(double t) {
    const Vector3d out(std::cos(t), std::sin(t), 0);
    return {kOrigin + kRadius * out, Vector3d::UnitZ(), out};
}

CurvePoint on_rib(double share) {
    return {kOrigin + Vector3d(kRibFrom + (kRibTo - kRibFrom) * share, kRibY, 0), Vector3d::UnitY(), Vector3d::UnitZ()};
}

void add_seam(PartResult& part, bool closed, CurvePoint (*curve)(double), double end, int points,
              const CubicBSpline& spline) {
    Seam seam;
    seam.closed = closed;
    seam.confidence = 0.97;
    SeamModel model;
    model.closed = closed;
    model.curve = spline;
    model.length_mm = ArcLength(spline).length();
    model.residual_rms_mm = 0.008;
    model.residual_max_mm = 0.021;
    model.degrees_of_freedom = 3.0 * static_cast<double>(spline.control.size());
    model.model = closed ? "saddle" : "spline";
    model.reason = closed ? "the pipe is round" : "no saddle: neither flank is a cylinder";
    if (closed) {
        model.saddle = SaddleParameters{SurfaceShape::plane, {kRadius, 0.004}, {}, Measured{kPi / 2, 0.0002}, {}};
    }
    Nodes nodes;
    nodes.max_chord_error_mm = 0.046;
    for (int i = 0; i < points; ++i) {
        const CurvePoint c = curve(end * i / (closed ? points : points - 1));
        const bool modelled = closed && i > points / 2 && i < points / 2 + points / 25;
        seam.points.push_back({c.p, c.n1, c.n2, 0.012 + 0.004 * std::sin(0.1 * i), modelled});
        const double station = nearest_parameter(spline, c.p);
        model.flanks.push_back({ArcLength(spline).station(station), c.n1, c.n2, 0.012, modelled});
        if (i % (closed ? 12 : points - 1) == 0) {
            nodes.index.push_back(static_cast<std::size_t>(i));
        }
    }
    part.extraction.seams.push_back(seam);
    part.models.push_back(model);
    part.nodes.push_back(nodes);
}

void add_deviation(PartResult& part, double tolerance, double amplitude) {
    const SeamModel& model = part.models.back();
    const ArcLength arc(model.curve);
    Deviation deviation;
    const int count = static_cast<int>(model.length_mm / 0.5);
    double squares = 0;
    for (int i = 0; i < count; ++i) {
        DeviationSample s;
        s.station_mm = model.length_mm * i / (model.closed ? count : count - 1);
        s.p = position(model.curve, arc.parameter(s.station_mm));
        s.flank1_mm = amplitude * std::sin(0.07 * s.station_mm) + 0.2 * ripple(static_cast<std::size_t>(i));
        s.flank2_mm = 0.6 * amplitude * std::cos(0.11 * s.station_mm) + 0.2 * ripple(static_cast<std::size_t>(i) + 999);
        s.distance_mm = std::hypot(s.flank1_mm, s.flank2_mm);
        s.sigma_mm = 0.004;
        s.covered = !(model.closed && i > 40 && i < 48);
        deviation.samples.push_back(s);
        squares += s.distance_mm * s.distance_mm / count;
        deviation.max_mm = std::max(deviation.max_mm, s.distance_mm);
    }
    deviation.signed_mean_mm = -0.0012345678;
    deviation.rms_mm = std::sqrt(squares);
    deviation.p50_mm = 0.6 * deviation.max_mm;
    deviation.p95_mm = 0.9 * deviation.max_mm;
    deviation.p997_mm = 0.99 * deviation.max_mm;
    deviation.coverage = model.closed ? 0.981 : 1;
    deviation.tolerance_mm = tolerance;
    deviation.pass = deviation.max_mm <= tolerance;
    deviation.verdict = deviation.pass ? "every checked sample lies within the tolerance"
                                       : "the largest deviation is above the tolerance";
    part.deviations.push_back(deviation);
}

/// Along a model at constant speed, the torch on the bisector of the flanks.
void add_travel(PartResult& part, int seam, double& time) {
    const SeamModel& model = part.models[static_cast<std::size_t>(seam)];
    const ArcLength arc(model.curve);
    const int moves = static_cast<int>(model.length_mm / 1.5);
    for (int i = 0; i <= moves; ++i) {
        Waypoint w;
        w.seam = seam;
        w.index = i;
        w.kind = i == 0 ? WaypointKind::weld_start : i == moves ? WaypointKind::weld_end : WaypointKind::weld;
        w.station_mm = model.length_mm * i / moves;
        // A hair before the end of a closed curve, where the tangent of the last span is meant.
        const double u = arc.parameter(w.station_mm);
        w.p = position(model.curve, u);
        const FlankSample flanks = flanks_at(model, w.station_mm);
        Eigen::Matrix3d axes;
        axes.col(2) = -(flanks.n1 + flanks.n2).normalized();
        axes.col(0) = (tangent(model.curve, u) - axes.col(2) * axes.col(2).dot(tangent(model.curve, u))).normalized();
        axes.col(1) = axes.col(2).cross(axes.col(0));
        w.q = Eigen::Quaterniond(axes);
        w.speed_mm_s = 8;
        time += i == 0 ? 3 : model.length_mm / moves / 8;
        w.time_s = time;
        part.plan.waypoints.push_back(w);
    }
    part.planned_seams.push_back(seam);
}

/// Uniform periodic cubic through a circle: with this radius of the control polygon the knots lie on the circle.
CubicBSpline circle_spline(int n) {
    CubicBSpline spline;
    spline.periodic = true;
    const double control_radius = kRadius * 3 / (2 + std::cos(2 * kPi / n));
    for (int i = 0; i < n; ++i) {
        const double t = 2 * kPi * (i - 1) / n;
        spline.control.push_back(kOrigin + Vector3d(control_radius * std::cos(t), control_radius * std::sin(t), 0));
    }
    for (int i = 0; i <= n; ++i) {
        spline.knots.push_back(2 * kPi * kRadius * i / n);
    }
    return spline;
}

CubicBSpline rib_spline() {
    CubicBSpline spline;
    const double length = kRibTo - kRibFrom;
    spline.knots = {0, 0, 0, 0, length, length, length, length};
    for (int i = 0; i < 4; ++i) {
        spline.control.push_back(on_rib(i / 3.0).p);
    }
    return spline;
}

}  // namespace

PartResult example_part(bool pass) {
    PartResult part;
    part.scan = example_scan();
    part.config.plan.speed_mm_s = 8;
    part.config.validate.min_coverage = 0.85;
    part.extraction.spacing_mm = 0.45;
    part.extraction.noise_mm = 0.035;
    part.extraction.orientation_reason = "the file says where the sensor stood";
    part.extraction.remarks = {
        "a candidate of 6.1 mm between plate & clamp was dropped: shorter than 12 mm <min_length_mm>"};
    add_seam(part, true, on_circle, 2 * kPi, 360, circle_spline(36));
    add_deviation(part, 0.1, 0.04);
    add_seam(part, false, on_rib, 1, 240, rib_spline());
    add_deviation(part, 0.1, pass ? 0.03 : 0.13);
    double time = 0;
    add_travel(part, 0, time);
    if (pass) {
        add_travel(part, 1, time);
    }
    part.plan.duration_s = time + 2;
    part.plan.max_chord_error_mm = 0.0094;
    part.plan.max_speed_error = 0.0003;
    part.plan.max_turn_deg = 2.86;
    part.programs = {{"abb", "seampath.mod", "MODULE seampath\nENDMODULE\n", 0.0005, 0.00061, 0.00002, 0},
                     {"ur", "seampath.script", "def seampath():\nend\n", 0.0005, 0.00048, 0.00004, 0.000001}};
    part.timings = {{"read", 0.213, false, "130 000 points in, 17 dropped"}, {"extract", 1.02, true, "2 seams"}};
    return part;
}

PartResult part_without_seams() {
    PartResult part;
    part.scan = example_scan();
    part.extraction.spacing_mm = 0.45;
    part.extraction.noise_mm = 0.035;
    part.extraction.remarks = {"only one surface was found"};
    return part;
}

}  // namespace seampath::test
