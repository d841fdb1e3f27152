#include "datasets/shapes.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/portable_math.hpp"

namespace seampath {
namespace {

constexpr double kEdgeSlack = 1e-9;  // mm by which neighbouring faces overlap, so that no ray slips between them

double value(const Plane& plane, const Eigen::Vector3d& p) {
    return plane.n.dot(p - plane.p);
}

double value(const Cylinder& cylinder, const Eigen::Vector3d& p) {
    const Eigen::Vector3d d = p - cylinder.p;
    return (d - d.dot(cylinder.axis) * cylinder.axis).norm() - cylinder.radius;
}

double value(const SineWall& wall, const Eigen::Vector3d& p) {
    return wall.side * (p.y() - wall.offset - wall.amplitude * portable::sin(wall.wave_number * p.x()));
}

bool is_inside(const Surface& surface, const Eigen::Vector3d& p) {
    return std::all_of(surface.inside_of.begin(), surface.inside_of.end(),
                       [&](const Shape& shape) { return signed_value(shape, p) <= kEdgeSlack; });
}

/// Takes crossings in ascending order until one lies on the kept part of the surface, between 0 and the nearest so far.
class Nearest {
public:
    Nearest(const Ray& ray, double limit) : ray_(ray), t_(limit) {}
    bool reaches(double t) const { return t < t_; }
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

bool cross(const Plane& plane, const Surface& surface, const Ray& ray, Nearest& nearest) {
    const double slope = plane.n.dot(ray.direction);
    return slope != 0 && nearest.offer(surface, plane.n.dot(plane.p - ray.origin) / slope);
}

bool cross(const Cylinder& cylinder, const Surface& surface, const Ray& ray, Nearest& nearest) {
    const Eigen::Vector3d from_axis = ray.origin - cylinder.p;
    const Eigen::Vector3d o = from_axis - from_axis.dot(cylinder.axis) * cylinder.axis;
    const Eigen::Vector3d d = ray.direction - ray.direction.dot(cylinder.axis) * cylinder.axis;
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

/// The turning points of g cut the ray into pieces on which g is monotone, each with at most one crossing.
bool cross(const SineWall& wall, const Surface& surface, const Ray& ray, Nearest& nearest) {
    const WallProfile profile{wall, ray};
    double begin = 0;
    double end = nearest.limit();
    const double reach = std::abs(wall.amplitude);
    if (std::abs(ray.direction.y()) < 1e-12) {
        if (std::abs(ray.origin.y() - wall.offset) > reach) {
            return false;
        }
    } else {
        const double t1 = (wall.offset - reach - ray.origin.y()) / ray.direction.y();
        const double t2 = (wall.offset + reach - ray.origin.y()) / ray.direction.y();
        begin = std::max(begin, std::min(t1, t2) - kEdgeSlack);
        end = std::min(end, std::max(t1, t2) + kEdgeSlack);
    }
    for (const Shape& shape : surface.inside_of) {
        const Plane* plane = std::get_if<Plane>(&shape);
        if (!plane) {
            continue;
        }
        const double slope = plane->n.dot(ray.direction);
        const double t = plane->n.dot(plane->p - ray.origin) / slope;
        if (slope > 0) {
            end = std::min(end, t + 1e-6);
        } else if (slope < 0) {
            begin = std::max(begin, t - 1e-6);
        }
    }
    if (!(begin < end)) {
        return false;
    }
    std::vector<double> cut{begin, end};
    const double phase_rate = wall.wave_number * ray.direction.x();
    const double ratio = ray.direction.y() / (wall.amplitude * phase_rate);
    if (phase_rate != 0 && std::abs(ratio) < 1) {
        const double angle = portable::acos(ratio);
        const double phase = wall.wave_number * ray.origin.x();
        const double first = std::min(phase + begin * phase_rate, phase + end * phase_rate);
        const double last = std::max(phase + begin * phase_rate, phase + end * phase_rate);
        for (const double start : {angle, -angle}) {
            const double turn = 2 * portable::kPi;
            for (double at = start + std::ceil((first - start) / turn) * turn; at < last; at += turn) {
                cut.push_back((at - phase) / phase_rate);
            }
        }
        std::sort(cut.begin(), cut.end());
    }
    for (std::size_t i = 0; i + 1 < cut.size(); ++i) {
        if ((profile.g(cut[i]) < 0) != (profile.g(cut[i + 1]) < 0) &&
            nearest.offer(surface, root(profile, cut[i], cut[i + 1]))) {
            return true;
        }
    }
    return false;
}

}  // namespace

double signed_value(const Shape& shape, const Eigen::Vector3d& p) {
    return std::visit([&](const auto& s) { return value(s, p); }, shape);
}

Eigen::Vector3d normal(const Shape& shape, const Eigen::Vector3d& p) {
    if (const auto* plane = std::get_if<Plane>(&shape)) {
        return plane->n;
    }
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
        const Eigen::Vector3d d = p - cylinder->p;
        return (d - d.dot(cylinder->axis) * cylinder->axis).normalized();
    }
    const auto& wall = std::get<SineWall>(shape);
    const double slope = wall.amplitude * wall.wave_number * portable::cos(wall.wave_number * p.x());
    return wall.side * Eigen::Vector3d(-slope, 1, 0).normalized();
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
