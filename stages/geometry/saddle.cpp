#include "stages/geometry/saddle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/gauss_legendre.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

// Least cosine between branch axis and header normal. At 1e-4 (radii equal to 5e-9 of themselves) the curve turns
// through 90 degrees within a ten-thousandth of its radius: to a torch, and soon to double precision, a corner.
constexpr double kLeastCrossing = 1e-4;

// A discriminant this far below 0, as a share of its largest value, is a miss and not rounding.
constexpr double kMiss = 1e-10;

// Angles at which the discriminant, a trigonometric polynomial of degree 2, is looked at before its least value is
// refined.
constexpr int kLooks = 720;

// Pieces that the arc-length table begins with, and how often one may be halved.
constexpr int kFirstPieces = 16, kMostHalvings = 40;
constexpr double kPieceTolerance = 1e-13;

std::string degrees(double rad) {
    return fixed(rad * 180 / std::numbers::pi, 2) + " deg";
}

Vector3d unit(const Vector3d& v, const char* what) {
    if (!(v.norm() > 0) || !v.allFinite()) {
        throw InputError(std::string("saddle: ") + what +
                         " is no direction; a finite vector that is not zero is needed");
    }
    return v.normalized();
}

void require_size(double value, const char* what) {
    if (!(value > 0) || !std::isfinite(value)) {
        throw InputError(std::string("saddle: ") + what + " is " + shortest(value) +
                         "; a finite size above 0 is needed");
    }
}

Plane checked(Plane s) {
    s.normal = unit(s.normal, "the header's normal");
    return s;
}
Cylinder checked(Cylinder s) {
    require_size(s.radius, "the header's radius, mm,");
    s.axis = unit(s.axis, "the header's axis");
    return s;
}
Cone checked(Cone s) {
    if (!(s.half_angle > 0 && s.half_angle < std::numbers::pi / 2)) {
        throw InputError("saddle: the header's half angle is " + degrees(s.half_angle) +
                         "; an angle between 0 and 90 deg is needed");
    }
    s.axis = unit(s.axis, "the header's axis");
    return s;
}
Sphere checked(Sphere s) {
    require_size(s.radius, "the header's radius, mm,");
    return s;
}
Ellipsoid checked(Ellipsoid s) {
    for (const double semi_axis : s.semi_axes) {
        require_size(semi_axis, "a semi-axis of the header, mm,");
    }
    return s;
}

// Theta of the least value of f near the best of its samples: golden section.
template <class Function>
double lowest(const Function& f) {
    int best = 0;
    for (int i = 1; i < kLooks; ++i) {
        best = f(kTurn * i / kLooks) < f(kTurn * best / kLooks) ? i : best;
    }
    constexpr double kGolden = 0.6180339887498949;
    double a = kTurn * (best - 1) / kLooks, b = kTurn * (best + 1) / kLooks;
    for (int i = 0; i < 60; ++i) {
        const double x1 = b - kGolden * (b - a), x2 = a + kGolden * (b - a);
        (f(x1) < f(x2) ? b : a) = f(x1) < f(x2) ? x2 : x1;
    }
    return 0.5 * (a + b);
}

}  // namespace

SaddleCurve::SaddleCurve(Cylinder branch, const Vector3d& zero, const Header& header)
    : branch_(std::move(branch)), header_(std::visit([](const auto& s) { return quadric(checked(s)); }, header)) {
    require_size(branch_.radius, "the branch's radius, mm,");
    if (!branch_.point.allFinite() || !header_.origin.allFinite()) {
        throw InputError("saddle: a position of the branch or the header is not finite; finite coordinates are needed");
    }
    branch_.axis = unit(branch_.axis, "the branch's axis");
    e1_ = unit(across(zero, branch_.axis), "the direction of branch angle 0, square to the branch's axis,");
    e2_ = e1_.cross(branch_.axis);
    // The point of the axis that is nearest to the header: u then loses no digits to where the branch was given.
    branch_.point += branch_.axis.dot(header_.origin - branch_.point) * branch_.axis;
    check_meets_all_round();
    check_has_no_corner();
    if (const auto* cone = std::get_if<Cone>(&header)) {
        check_stays_on(*cone);
    }

    const double tolerance = kPieceTolerance * speed_integral(0, kTurn);
    theta_.push_back(0);
    station_.push_back(0);
    for (int piece = 0; piece < kFirstPieces; ++piece) {
        const double from = kTurn * piece / kFirstPieces, to = kTurn * (piece + 1) / kFirstPieces;
        add_pieces(from, to, speed_integral(from, to), tolerance, 0);
    }
}

SaddleCurve::Crossing SaddleCurve::crossing(double theta) const {
    const double cosine = std::cos(theta), sine = std::sin(theta);
    const Vector3d& a = branch_.axis;
    Crossing x;
    x.n1 = cosine * e1_ + sine * e2_;
    x.e_t = -sine * e1_ + cosine * e2_;
    x.w0 = branch_.point + branch_.radius * x.n1 - header_.origin;
    const Vector3d Aw = header_.A * x.w0;
    x.alpha = a.dot(header_.A * a);
    x.beta = a.dot(Aw + header_.b);
    x.gamma = x.w0.dot(Aw + 2 * header_.b) + header_.c;
    return x;
}

void SaddleCurve::check_meets_all_round() const {
    const auto discriminant = [this](double theta) { return crossing(theta).discriminant(); };
    const Crossing first = crossing(0);
    if (first.alpha == 0 && first.beta < 0) {
        throw InputError("saddle: the branch's axis points into the header; it must point out of the material");
    }
    double most = 0;
    int misses = 0;
    for (int i = 0; i < kLooks; ++i) {
        const double D = discriminant(kTurn * i / kLooks);
        most = std::max(most, D);
        misses += D < 0 ? 1 : 0;
    }
    if (!(most > 0)) {
        throw InputError(
            "saddle: the branch passes beside the header, or runs along it, at every branch angle; move or tilt the "
            "branch so that its wall meets the header all round");
    }
    const double worst = lowest(discriminant);
    if (discriminant(worst) < -kMiss * most) {
        throw InputError("saddle: partial penetration: about branch angle " + degrees(worst) + ", over some " +
                         fixed(100.0 * misses / kLooks, 1) +
                         " % of a turn, the branch's wall passes beside the header, so no seam goes round the branch; "
                         "a smaller branch radius or a smaller offset is needed");
    }
}

void SaddleCurve::check_has_no_corner() const {
    const auto crossing_cosine = [this](double theta) {
        return crossing(theta).discriminant() > 0 ? at(theta).n2.dot(branch_.axis) : 0;
    };
    const double touch = lowest(crossing_cosine);
    if (!(crossing_cosine(touch) >= kLeastCrossing)) {
        throw InputError("saddle: at branch angle " + degrees(touch) +
                         " the branch's wall only touches the header or runs along it (the cosine between branch axis "
                         "and header normal is " +
                         shortest(crossing_cosine(touch)) + "; at least " + shortest(kLeastCrossing) +
                         " is needed): the curve has a corner there, as for equal radii without offset; a branch that "
                         "is smaller, further in or steeper is needed");
    }
}

void SaddleCurve::check_stays_on(const Cone& cone) const {
    for (int i = 0; i < kLooks; ++i) {
        if ((at(kTurn * i / kLooks).p - cone.apex).dot(cone.axis) <= 0) {
            throw InputError("saddle: at branch angle " + degrees(kTurn * i / kLooks) +
                             " the branch leaves the cone beyond its apex; its axis must point out of the cone's side");
        }
    }
}

SaddlePoint SaddleCurve::at(double theta) const {
    const Crossing x = crossing(theta);
    const double r = branch_.radius;
    const Vector3d& a = branch_.axis;
    const double root = std::sqrt(std::max(0.0, x.discriminant()));
    // Both forms of the same root; each is used where it adds rather than subtracts.
    const double u = x.beta > 0 ? -x.gamma / (x.beta + root) : (root - x.beta) / x.alpha;
    SaddlePoint s;
    s.theta = theta;
    const Vector3d w = x.w0 + u * a;
    s.p = header_.origin + w;
    const Vector3d half_gradient = header_.A * w + header_.b;
    s.n1 = x.n1;
    s.n2 = half_gradient.normalized();
    const Vector3d along = r * x.e_t - r * s.n2.dot(x.e_t) / s.n2.dot(a) * a;
    s.speed_mm_rad = along.norm();
    s.tangent = along / s.speed_mm_rad;
    const double c = s.n1.dot(s.n2), sine = s.n1.cross(s.n2).norm();
    s.opening = std::numbers::pi - std::atan2(sine, c);
    const double ta = s.tangent.dot(a);
    const double k1 = -(1 - ta * ta) / r;
    const double k2 = -s.tangent.dot(header_.A * s.tangent) / half_gradient.norm();
    // k1^2 + k2^2 - 2 k1 k2 c as a sum of squares.
    s.curvature_per_mm = std::hypot(k1 - k2 * c, k2 * sine) / sine;
    return s;
}

double SaddleCurve::speed(double theta) const {
    return at(theta).speed_mm_rad;
}

double SaddleCurve::speed_integral(double from, double to) const {
    return gauss_legendre([this](double theta) { return speed(theta); }, from, to);
}

void SaddleCurve::add_pieces(double from, double to, double whole, double tolerance, int depth) {
    const double middle = 0.5 * (from + to);
    const double left = speed_integral(from, middle), right = speed_integral(middle, to);
    if (depth < kMostHalvings && std::abs(left + right - whole) > tolerance) {
        add_pieces(from, middle, left, tolerance, depth + 1);
        add_pieces(middle, to, right, tolerance, depth + 1);
        return;
    }
    theta_.insert(theta_.end(), {middle, to});
    station_.push_back(station_.back() + left);
    station_.push_back(station_.back() + right);
}

double SaddleCurve::station(double theta) const {
    const double turns = std::floor(theta / kTurn), rest = std::max(0.0, theta - turns * kTurn);
    const auto above = std::upper_bound(theta_.begin(), theta_.end() - 1, rest);
    const auto i = static_cast<std::size_t>(above - theta_.begin()) - 1;
    return turns * length() + station_[i] + speed_integral(theta_[i], rest);
}

double SaddleCurve::theta(double station_mm) const {
    const double turns = std::floor(station_mm / length()), rest = std::max(0.0, station_mm - turns * length());
    const auto above = std::upper_bound(station_.begin(), station_.end() - 1, rest);
    const auto i = static_cast<std::size_t>(above - station_.begin()) - 1;
    const double from = theta_[i], to = std::min(theta_[i + 1], kTurn);
    double theta = from + (to - from) * (rest - station_[i]) / (station_[i + 1] - station_[i]);
    for (int iteration = 0; iteration < 20; ++iteration) {
        const double step = (station_[i] + speed_integral(from, theta) - rest) / speed(theta);
        theta = std::clamp(theta - step, from, to);
        if (std::abs(step) <= 1e-16 * (1 + theta)) {
            break;
        }
    }
    return turns * kTurn + theta;
}

}  // namespace seampath
