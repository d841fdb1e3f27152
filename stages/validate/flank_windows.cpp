#include "stages/validate/flank_windows.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "stages/geometry/bspline.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/whole_flank.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector3d;

constexpr double kGate = 8;  // of the points' 1-sigma: what lies off a surface must be seen to lie off it

// The scan's points beside a sample that are near a surface, of which `off(x)` is the distance, as far as `gate(u)`
// allows.
template <class Off, class Gate>
std::vector<SlabPoint> slab_near(const Course& course, const Window& window, const SectionWindow& extent, std::size_t k,
                                 const Off& off, const Gate& gate) {
    const double half = 0.5 * course.step;
    const Vector3d &p = window.model.p, &n = window.normal(k);
    Vector3d low = p, high = p;
    for (const double u : {extent.band, 0.5 * (extent.band + extent.away), extent.away}) {
        for (const double s : {-half, half}) {
            const Vector3d corner = p + u * window.d[k] + s * window.t;
            const Vector3d foot = corner - off(corner) * n;
            low = low.cwiseMin(foot - Vector3d::Constant(gate(u)));
            high = high.cwiseMax(foot + Vector3d::Constant(gate(u)));
        }
    }
    std::vector<SlabPoint> slab;
    course.ground.grid.for_cells_in_box(low, high, [&](std::size_t cell) {
        for (const Eigen::Vector3f& q : course.ground.grid.points(cell)) {
            const Vector3d x = q.cast<double>(), v = x - p;
            const double u = v.dot(window.d[k]), s = v.dot(window.t), z = off(x);
            if (std::abs(s) <= half && u >= extent.band && u <= extent.away && std::abs(z) <= gate(u)) {
                slab.push_back({q, static_cast<float>(u), static_cast<float>(z), 0});
            }
        }
    });
    return slab;
}

}  // namespace

std::vector<Window> windows_along(const Course& course, const SeamModel& model,
                                  const std::vector<DeviationSample>& samples) {
    const Ground& ground = course.ground;
    std::vector<Window> windows(samples.size());
    parallel_for(samples.size(), 4, [&](std::size_t i) {
        const FlankSample flanks = flanks_at(model, samples[i].station_mm);
        Window& window = windows[i];
        window.model = {samples[i].p - ground.origin, course.outwards * flanks.n1.normalized(),
                        course.outwards * flanks.n2.normalized()};
        window.t = window.model.n1.cross(window.model.n2).normalized();
        window.d[0] = window.t.cross(window.model.n1);
        window.d[1] = window.model.n2.cross(window.t);
        window.fit = fit_section(ground.grid, ground.scale, window.model, course.limits);
    });
    return windows;
}

bool is_sure(const Course& course, const Window& window, std::size_t k) {
    return window.fit && window.fit->flank[k].sigma <= 2 * noise_of(course.ground.scale);
}

SectionWindow usual_extent(const Course& course, const std::vector<Window>& windows, std::size_t k) {
    std::vector<double> away;
    for (const Window& window : windows) {
        if (is_sure(course, window, k)) {
            away.push_back(window.fit->flank[k].window.away);
        }
    }
    SectionWindow extent = course.limits[k];
    extent.away = away.empty() ? extent.away : quantile(away, 0.5);
    return extent;
}

void take_slabs(const Course& course, std::vector<Window>& windows, std::size_t k) {
    parallel_for(windows.size(), 16, [&](std::size_t i) {
        Window& window = windows[i];
        if (!is_sure(course, window, k)) {
            return;
        }
        const Flank& flank = window.fit->flank[k];
        window.slab[k] = slab_near(
            course, window, flank.window, k,
            [&](const Vector3d& x) {
                const Vector3d v = x - window.model.p;
                return residual(flank, v.dot(window.d[k]), v.dot(window.t), v.dot(window.normal(k)));
            },
            [&](double) { return kGate * flank.fit.scale(); });
        const auto on = std::count_if(window.slab[k].begin(), window.slab[k].end(), [&](const SlabPoint& q) {
            return std::abs(q.off) <= 0.5 * kGate * flank.fit.scale();
        });
        window.explains[k] = static_cast<double>(on) >= kLeastExplained * static_cast<double>(window.slab[k].size());
    });
}

void look_by_model(const Course& course, std::vector<Window>& windows, std::size_t k) {
    constexpr double kSlope = 0.05;  // of the flank against the model's normal
    const SectionWindow& extent = course.limits[k];
    for (Window& window : windows) {
        window.slab[k] = slab_near(
            course, window, extent, k, [&](const Vector3d& x) { return window.normal(k).dot(x - window.model.p); },
            [&](double u) { return 4 * noise_of(course.ground.scale) + kSlope * u; });
    }
}

void look_on_surface(const Course& course, const SurfaceFit& surface, const SectionWindow& extent, std::size_t k,
                     Window& window) {
    window.slab[k] = slab_near(
        course, window, extent, k, [&](const Vector3d& x) { return surface.distance(x); },
        [&](double) { return kGate * surface.scale(); });
}

}  // namespace seampath::detail
