#include "pipeline/report_view.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/report_camera.hpp"
#include "pipeline/report_thin.hpp"
#include "stages/geometry/bspline.hpp"

namespace seampath {
namespace {

/// More samples a seam than this add nothing to the picture.
constexpr std::size_t kMaxSamples = 4000;

/// All seams together: some 600 kB of the page.
constexpr std::size_t kMaxSamplesOfAll = 9000;

/// Torch poses are shown this far apart, as a share of the scene's radius.
constexpr double kTorchSpacing = 0.07;

/// What a nominal model shows of itself: its points at the stations of its flanks.
std::vector<Seam> seams_of(const std::vector<SeamModel>& models) {
    std::vector<Seam> seams;
    for (const SeamModel& model : models) {
        Seam seam;
        seam.kind = model.kind;
        seam.closed = model.closed;
        const ArcLength arc(model.curve);
        for (const FlankSample& f : model.flanks) {
            seam.points.push_back({position(model.curve, arc.parameter(f.station_mm)), f.n1, f.n2, f.sigma_mm});
        }
        seams.push_back(std::move(seam));
    }
    return seams;
}

/// Middle and radius of what is to be in the picture: the seams, or where there is none the bulk of the scan (stray
/// points far away do not count).
void frame(const PartResult& part, const std::vector<Seam>& seams, ViewScene& scene) {
    std::array<std::vector<double>, 3> axis;
    const auto add = [&](const Eigen::Vector3d& p) {
        for (int k = 0; k < 3; ++k) {
            axis[static_cast<std::size_t>(k)].push_back(p[k]);
        }
    };
    for (const Seam& seam : seams) {
        for (const SeamPoint& point : seam.points) {
            add(point.p);
        }
    }
    const bool whole_scan = axis[0].empty();
    const double cut = whole_scan ? 0.03 : 0;
    for (std::size_t i = 0; whole_scan && i < part.scan.points.size(); ++i) {
        add(part.scan.position(i));
    }
    if (axis[0].empty()) {
        return;
    }
    Eigen::Vector3d low, high;
    for (int k = 0; k < 3; ++k) {
        auto& values = axis[static_cast<std::size_t>(k)];
        const auto at = [&](double share) {
            const auto place =
                values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
            std::nth_element(values.begin(), place, values.end());
            return *place;
        };
        low[k] = at(cut);
        high[k] = at(1 - cut);
    }
    scene.centre = (low + high) / 2;
    scene.radius_mm = std::max(1.0, (high - low).norm() / 2);
}

/// The seam of a nominal part: nothing of it was checked.
ViewSeam nominal_view(const SeamModel& model, const Seam& seam, const Scan& no_scan, const ViewScene& scene) {
    ViewSeam view;
    const std::size_t step = seam.points.size() / kMaxSamples + 1;
    for (std::size_t k = 0; k < seam.points.size(); k += step) {
        view.samples.push_back({seam.points[k].p - scene.centre, model.flanks[k].station_mm});
    }
    if (model.closed) {
        view.samples.push_back(view.samples.front());
        view.samples.back().station_mm = model.length_mm;
    }
    view.camera = best_camera({&seam, 1}, no_scan, scene);
    return view;
}

ViewSeam view_seam(const PartResult& part, std::size_t i, const ViewScene& scene) {
    const Seam& seam = part.extraction.seams[i];
    const Deviation& deviation = part.deviations[i];
    ViewSeam view;
    const std::size_t step =
        deviation.samples.size() / std::min(kMaxSamples, kMaxSamplesOfAll / part.models.size() + 1) + 1;
    for (std::size_t k = 0; k < deviation.samples.size(); ++k) {
        if (k % step == 0 || k + 1 == deviation.samples.size()) {
            const DeviationSample& s = deviation.samples[k];
            const bool modelled = flanks_at(part.models[i], s.station_mm).modelled;
            view.samples.push_back({s.p - scene.centre, s.station_mm, s.distance_mm, s.sigma_mm, s.covered, modelled,
                                    s.flank1_mm, s.flank2_mm});
        }
    }
    if (part.models[i].closed && !view.samples.empty()) {
        view.samples.push_back(view.samples.front());
        view.samples.back().station_mm = part.models[i].length_mm;
    }
    for (const Eigen::Vector3d& node : node_positions(seam, part.nodes[i])) {
        view.nodes.emplace_back(node - scene.centre);
    }
    view.tolerance_mm = deviation.tolerance_mm;
    view.camera = best_camera({&seam, 1}, part.scan, scene);
    return view;
}

bool welds(const Waypoint& waypoint) {
    return waypoint.kind == WaypointKind::weld_start || waypoint.kind == WaypointKind::weld ||
           waypoint.kind == WaypointKind::weld_end;
}

std::vector<ViewTorch> view_torch(const Plan& plan, const ViewScene& scene) {
    std::vector<ViewTorch> torch;
    double shown_at = 0;
    for (const Waypoint& waypoint : plan.waypoints) {
        const bool due = std::abs(waypoint.station_mm - shown_at) > kTorchSpacing * scene.radius_mm;
        if (welds(waypoint) && (due || waypoint.kind == WaypointKind::weld_start)) {
            torch.push_back({waypoint.p - scene.centre, waypoint.q * Eigen::Vector3d::UnitZ()});
            shown_at = waypoint.station_mm;
        }
    }
    return torch;
}

}  // namespace

ViewScene view_scene(const PartResult& part) {
    ViewScene scene;
    scene.nominal = part.nominal;
    const std::vector<Seam> seams = part.nominal ? seams_of(part.models) : part.extraction.seams;
    frame(part, seams, scene);
    scene.clouds = thin_scan(part.scan, seams, scene.centre);
    scene.camera = best_camera(seams, part.scan, scene);
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        if (part.nominal) {
            scene.seams.push_back(nominal_view(part.models[i], seams[i], part.scan, scene));
        } else {
            scene.seams.push_back(view_seam(part, i, scene));
            scene.scale_mm = std::max(scene.scale_mm, part.deviations[i].tolerance_mm);
        }
    }
    scene.torch = view_torch(part.plan, scene);
    return scene;
}

}  // namespace seampath
