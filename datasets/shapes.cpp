#include "datasets/shapes.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/portable_math.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

constexpr double kEdgeSlack = 1e-9;  // mm by which neighbouring faces overlap, so that no ray slips between them

double value(const PlaneShape& plane, const Vector3d& p) {
    return plane.n.dot(p - plane.p);
}

double value(const CylinderShape& cylinder, const Vector3d& p) {
    const Vector3d d = p - cylinder.p;
    return cylinder.side * ((d - d.dot(cylinder.axis) * cylinder.axis).norm() - cylinder.radius);
}

double value(const ConeShape& cone, const Vector3d& p) {
    const Vector3d d = p - cone.p;
    const double s = d.dot(cone.axis);
    return cone.side * ((d - s * cone.axis).norm() * cone.cos - s * cone.sin);
}

double value(const SphereShape& sphere, const Vector3d& p) {
    return (p - sphere.p).norm() - sphere.radius;
}

double value(const SineWall& wall, const Vector3d& p) {
    return wall.side * (p.y() - wall.offset - wall.amplitude * portable::sin(wall.wave_number * p.x()));
}

Vector3d normal_of(const PlaneShape& plane, const Vector3d&) {
    return plane.n;
}

Vector3d normal_of(const CylinderShape& cylinder, const Vector3d& p) {
    const Vector3d d = p - cylinder.p;
    return cylinder.side * (d - d.dot(cylinder.axis) * cylinder.axis).normalized();
}

Vector3d normal_of(const ConeShape& cone, const Vector3d& p) {
    const Vector3d d = p - cone.p;
    const Vector3d radial = (d - d.dot(cone.axis) * cone.axis).normalized();
    return cone.side * (cone.cos * radial - cone.sin * cone.axis);
}

Vector3d normal_of(const SphereShape& sphere, const Vector3d& p) {
    return (p - sphere.p).normalized();
}

Vector3d normal_of(const SineWall& wall, const Vector3d& p) {
    const double slope = wall.amplitude * wall.wave_number * portable::cos(wall.wave_number * p.x());
    return wall.side * Vector3d(-slope, 1, 0).normalized();
}

bool is_inside(const Surface& surface, const Vector3d& p) {
    return std::all_of(surface.inside_of.begin(), surface.inside_of.end(),
                       [&](const SceneShape& shape) { return signed_value(shape, p) <= kEdgeSlack; });
}

/// Takes crossings in ascending order until one lies on the kept part of the surface, between 0 and the nearest so far.
class Nearest {
public:
    Nearest(const Ray& ray, double limit) : ray_(ray), t_(limit) {}
    double limit() const { return t_; }
    bool offer(const Surface& surface, double t) {
        if (!(t > 0) || !(t < t_) || !is_inside(surface, ray_.origin + t * ray_.direction)) {
            return false;
        }
        t_ = t;
        return true;
    }

private:
    const Ray& ray_;
    double t_;
};

bool cross(const PlaneShape& plane, const Surface& surface, const Ray& ray, Nearest& nearest) {
    const double slope = plane.n.dot(ray.direction);
    return slope != 0 && nearest.offer(surface, plane.n.dot(plane.p - ray.origin) / slope);
}

bool cross(const CylinderShape& cylinder, const Surface& surface, const Ray& ray, Nearest& nearest) {
    const Vector3d from_axis = ray.origin - cylinder.p;
    const Vector3d o = from_axis - from_axis.dot(cylinder.axis) * cylinder.axis;
    const Vector3d d = ray.direction - ray.direction.dot(cylinder.axis) * cylinder.axis;
    const double a = d.squaredNorm();
    if (a == 0) {
        return false;
    }
    // From the point of the ray nearest to the axis: no cancellation however far the origin lies.
    const double middle = -o.dot(d) / a;
    const double rest = cylinder.radius * cylinder.radius - (o + middle * d).squaredNorm();
    if (rest < 0) {
        return false;
    }
    const double half = std::sqrt(rest / a);
    return nearest.offer(surface, middle - half) || nearest.offer(surface, middle + half);
}

/// With r the distance from the axis and s the way along it, r^2 cos^2 - s^2 sin^2 = a t^2 + 2 b t + c; of its roots,
/// those on the other nappe (s < 0) are none of the cone's.
bool cross(const ConeShape& cone, const Surface& surface, const Ray& ray, Nearest& nearest) {
    // From the point of the ray nearest to the apex: no cancellation however far the origin lies.
    const double middle = (cone.p - ray.origin).dot(ray.direction);
    const Vector3d o = ray.origin + middle * ray.direction - cone.p;
    const double s = o.dot(cone.axis);
    const double slope = ray.direction.dot(cone.axis);
    const Vector3d radial = o - s * cone.axis;
    const Vector3d radial_slope = ray.direction - slope * cone.axis;
    const double cos2 = cone.cos * cone.cos;
    const double sin2 = cone.sin * cone.sin;
    const double a = radial_slope.squaredNorm() * cos2 - slope * slope * sin2;
    const double b = radial.dot(radial_slope) * cos2 - s * slope * sin2;
    const double c = radial.squaredNorm() * cos2 - s * s * sin2;
    const double square = b * b - a * c;
    if (square < 0) {
        return false;
    }
    // A root that does not exist (a = 0 or q = 0) comes out as no finite number, and is refused.
    const double q = -(b + std::copysign(std::sqrt(square), b));
    const double one = q / a;
    const double other = c / q;
    bool hit = false;
    for (const double t : {std::min(one, other), std::max(one, other)}) {
        hit = hit || (s + t * slope > 0 && nearest.offer(surface, middle + t));
    }
    return hit;
}

bool cross(const SphereShape& sphere, const Surface& surface, const Ray& ray, Nearest& nearest) {
    const double middle = (sphere.p - ray.origin).dot(ray.direction);
    const double square =
        sphere.radius * sphere.radius - (ray.origin + middle * ray.direction - sphere.p).squaredNorm();
    if (square < 0) {
        return false;
    }
    const double half = std::sqrt(square);
    return nearest.offer(surface, middle - half) || nearest.offer(surface, middle + half);
}

/// g(t) = height of the ray over the wall, and its derivative.
struct WallProfile {
    const SineWall& wall;
    const Ray& ray;
    double g(double t) const {
        const double x = ray.origin.x() + t * ray.direction.x();
        return ray.origin.y() + t * ray.direction.y() - wall.offset -
               wall.amplitude * portable::sin(wall.wave_number * x);
    }
    double slope(double t) const {
        const double x = ray.origin.x() + t * ray.direction.x();
        return ray.direction.y() -
               wall.amplitude * wall.wave_number * ray.direction.x() * portable::cos(wall.wave_number * x);
    }
};

/// Root of a monotone g between low and high, whose values there differ in sign: Newton's method, by bisection wherever
/// a step would leave the bracket.
double root(const WallProfile& profile, double low, double high) {
    const bool rising = profile.g(low) < 0;
    double t = 0.5 * (low + high);
    for (int i = 0; i < 100; ++i) {
        const double g = profile.g(t);
        (((g < 0) == rising) ? low : high) = t;
        double next = t - g / profile.slope(t);
        if (!(next > low && next < high)) {
            next = 0.5 * (low + high);
        }
        if (std::abs(next - t) < 1e-12 * (1 + std::abs(t))) {
            return next;
        }
        t = next;
    }
    return t;
}

/// Piece of the ray, as lengths along it.
struct Piece {
    double begin;
    double end;

    /// Keeps what lies before the plane, plus a little so that a crossing on the plane itself is not lost.
    void keep_behind(const PlaneShape& plane, const Ray& ray) {
        const double kSlack = 1e-6;  // mm
        const double slope = plane.n.dot(ray.direction);
        const double t = plane.n.dot(plane.p - ray.origin) / slope;
        if (slope > 0) {
            end = std::min(end, t + kSlack);
        } else if (slope < 0) {
            begin = std::max(begin, t - kSlack);
        } else if (value(plane, ray.origin) > kEdgeSlack) {
            end = begin;
        }
    }
};

/// Ends of the pieces of the ray on which g is monotone: its turning points, where cos(wave_number x) = ratio.
std::vector<double> monotone_pieces(const SineWall& wall, const Ray& ray, const Piece& piece) {
    std::vector<double> ends{piece.begin, piece.end};
    const double phase_rate = wall.wave_number * ray.direction.x();
    const double ratio = ray.direction.y() / (wall.amplitude * phase_rate);
    if (!(std::abs(ratio) < 1)) {
        return ends;
    }
    const double angle = portable::acos(ratio);
    const double phase = wall.wave_number * ray.origin.x();
    const double phase_begin = phase + piece.begin * phase_rate;
    const double phase_end = phase + piece.end * phase_rate;
    const double turn = 2 * portable::kPi;
    for (const double start : {angle, -angle}) {
        const double turns = std::ceil((std::min(phase_begin, phase_end) - start) / turn);
        for (double at = start + turns * turn; at < std::max(phase_begin, phase_end); at += turn) {
            ends.push_back((at - phase) / phase_rate);
        }
    }
    std::sort(ends.begin(), ends.end());
    return ends;
}

/// Each monotone piece holds at most one crossing.
bool cross(const SineWall& wall, const Surface& surface, const Ray& ray, Nearest& nearest) {
    Piece piece{0, nearest.limit()};
    const Vector3d reach(0, std::abs(wall.amplitude), 0);
    const Vector3d middle(0, wall.offset, 0);
    piece.keep_behind({middle + reach, Vector3d::UnitY()}, ray);
    piece.keep_behind({middle - reach, -Vector3d::UnitY()}, ray);
    for (const SceneShape& shape : surface.inside_of) {
        if (const PlaneShape* plane = std::get_if<PlaneShape>(&shape)) {
            piece.keep_behind(*plane, ray);
        }
    }
    if (!(piece.begin < piece.end)) {
        return false;
    }
    const WallProfile profile{wall, ray};
    const std::vector<double> ends = monotone_pieces(wall, ray, piece);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        if ((profile.g(ends[i]) < 0) != (profile.g(ends[i + 1]) < 0) &&
            nearest.offer(surface, root(profile, ends[i], ends[i + 1]))) {
            return true;
        }
    }
    return false;
}

}  // namespace

double signed_value(const SceneShape& shape, const Eigen::Vector3d& p) {
    return std::visit([&](const auto& s) { return value(s, p); }, shape);
}

Eigen::Vector3d normal(const SceneShape& shape, const Eigen::Vector3d& p) {
    return std::visit([&](const auto& s) { return normal_of(s, p); }, shape);
}

std::optional<Hit> first_hit(const std::vector<Surface>& surfaces, const Ray& ray, double limit) {
    Nearest nearest(ray, limit);
    std::optional<Hit> hit;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const Surface& surface = surfaces[i];
        if (std::visit([&](const auto& shape) { return cross(shape, surface, ray, nearest); }, surface.shape)) {
            hit = Hit{nearest.limit(), i};
        }
    }
    return hit;
}

}  // namespace seampath
