#include "pipeline/fixture_calibration.hpp"

#include <algorithm>

#include "pipeline/digest.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* kSeamPoints = "seam_points.csv";

void from_balls(const Scan& scan, FixtureCalibration& c) {
    const std::vector<FoundBall> found = find_balls(scan, c.nominal.ball_diameter_mm / 2);
    std::vector<Vector3d> centres;
    for (const FoundBall& ball : found) {
        centres.push_back(ball.centre);
    }
    const auto match = match_balls(c.nominal.features, centres, c.nominal.match_tolerance_mm);
    std::vector<FrameFeature> features;
    std::string missing;
    for (std::size_t i = 0; i < match.size(); ++i) {
        const NamedPoint& nominal = c.nominal.features[i];
        if (!match[i]) {
            missing += (missing.empty() ? "" : ", ") + nominal.name;
            continue;
        }
        const FoundBall& ball = found[*match[i]];
        features.push_back({nominal.name, 0, false, {{nominal.p, ball.centre, ball.covariance}}, {}});
        c.numbers.push_back({nominal.name + ": points", static_cast<double>(ball.points), ""});
        c.numbers.push_back({nominal.name + ": noise of its points", ball.scale_mm, "mm"});
        c.numbers.push_back({nominal.name + ": radius of a free fit", ball.free_radius_mm, "mm"});
    }
    c.frame = calibrate_frame(features, c.nominal.work_points, c.nominal.frame);
    if (!missing.empty()) {
        c.frame.notes.push_back("not found in the scan: " + missing);
    }
    if (found.size() > features.size()) {
        c.frame.notes.push_back(std::to_string(found.size() - features.size()) +
                                " more balls of this size were found, which are no nominal ones");
    }
}

const TouchedRow& row_of(const std::vector<TouchedRow>& rows, const std::string& name) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const TouchedRow& row) { return row.name == name; });
    if (found == rows.end()) {
        std::vector<std::string_view> names;
        for (const auto& row : rows) {
            names.emplace_back(row.name);
        }
        throw InputError("points: \"" + name + "\" was not touched; there are " + join(names) + hint(name, names));
    }
    return *found;
}

void refuse_unknown(const std::vector<TouchedRow>& rows, const std::vector<NamedPoint>& nominal) {
    std::vector<std::string_view> names;
    for (const auto& point : nominal) {
        names.emplace_back(point.name);
    }
    for (const TouchedRow& row : rows) {
        if (std::find(names.begin(), names.end(), row.name) == names.end()) {
            throw InputError("points: \"" + row.name + "\" is no nominal point; there are " + join(names) +
                             hint(row.name, names));
        }
    }
}

void from_points(const std::vector<TouchedRow>& rows, FixtureCalibration& c) {
    refuse_unknown(rows, c.nominal.features);
    std::vector<std::string> names;
    std::vector<FramePoint> points;
    std::vector<Vector3d> nominal, measured;
    std::vector<FrameFeature> features;
    for (const NamedPoint& feature : c.nominal.features) {
        const TouchedRow& row = row_of(rows, feature.name);
        const FramePoint point{feature.p, row.p, row.sigma_mm * row.sigma_mm * Eigen::Matrix3d::Identity()};
        names.push_back(feature.name);
        points.push_back(point);
        nominal.push_back(feature.p);
        measured.push_back(row.p);
        features.push_back({feature.name, 0, false, {point}, {}});
    }
    if (c.nominal.method == FixtureMethod::points) {
        c.frame = calibrate_frame(features, c.nominal.work_points, c.nominal.frame);
    } else {
        features = three_point_features(names, points);
        c.frame = calibrate_frame(features, c.nominal.work_points, c.nominal.frame, rigid_through(nominal, measured));
    }
}

void from_planes(const std::vector<TouchedRow>& rows, FixtureCalibration& c) {
    std::vector<NamedPoint> all;
    std::vector<DatumPlane> planes;
    for (const NominalPlane& nominal : c.nominal.planes) {
        DatumPlane plane{nominal.name, nominal.normal, nominal.offset_mm, {}};
        for (const NamedPoint& point : nominal.points) {
            const TouchedRow& row = row_of(rows, point.name);
            plane.touched.push_back({point.p, row.p, row.sigma_mm});
            all.push_back(point);
        }
        planes.push_back(std::move(plane));
    }
    refuse_unknown(rows, all);
    c.frame = calibrate_planes(planes, c.nominal.work_points, c.nominal.frame);
}

void from_probed_planes(const Scan& scan, FixtureCalibration& c) {
    std::vector<DatumPlane> planes;
    for (const NominalPlane& nominal : c.nominal.planes) {
        planes.push_back({nominal.name, nominal.normal, nominal.offset_mm, {}});
        for (const NamedPoint& point : nominal.points) {
            planes.back().touched.push_back({point.p, Vector3d::Zero(), 0});
        }
    }
    const std::vector<PlaneProbe> probes = probe_planes(scan, planes, *c.nominal.probes);
    auto probe = probes.begin();
    for (const NominalPlane& nominal : c.nominal.planes) {
        for (const NamedPoint& point : nominal.points) {
            c.numbers.push_back({point.name + ": points", static_cast<double>(probe->points), ""});
            c.numbers.push_back({point.name + ": noise of its points", probe->scale_mm, "mm"});
            c.numbers.push_back({point.name + ": 1-sigma of the place", probe->sigma_mm, "mm"});
            ++probe;
        }
    }
    c.frame = calibrate_planes(planes, c.nominal.work_points, c.nominal.frame);
}

// The place at a share of a seam's length.
Vector3d place_along(const NominalSeam& seam, double share) {
    std::vector<Vector3d> points = seam.points;
    if (seam.closed) {
        points.push_back(points.front());
    }
    double length = 0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        length += (points[i + 1] - points[i]).norm();
    }
    double due = share * length;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Vector3d d = points[i + 1] - points[i];
        if (due < d.norm()) {
            return points[i] + due * d.normalized();
        }
        due -= d.norm();
    }
    return points.back();
}

// What a frame is worth along each seam: at its quarters. Between places of a line it is no larger than at its ends.
std::vector<WorkPoint> with_seams(std::vector<WorkPoint> work_points, const std::vector<NominalSeam>& seams) {
    constexpr std::array<std::pair<const char*, double>, 5> kPlaces{
        {{"begin", 0}, {"first quarter", 0.25}, {"middle", 0.5}, {"third quarter", 0.75}, {"end", 1}}};
    for (const NominalSeam& seam : seams) {
        for (const auto& [name, share] : kPlaces) {
            if (!seam.points.empty() && !(seam.closed && share == 1)) {
                work_points.push_back({seam.name + ": " + name, place_along(seam, share)});
            }
        }
    }
    return work_points;
}

void from_seams(const std::vector<std::vector<MeasuredSeamPoint>>& measured, FixtureCalibration& c) {
    c.frame = calibrate_seams(c.nominal.seams, measured, c.nominal.work_points, c.nominal.frame);
    c.numbers.push_back({"measured seams", static_cast<double>(measured.size()), ""});
}

BestFitOptions search_options(const NominalFixture& nominal) {
    const NominalSurfaceFile& surface = nominal.surface;
    return {nominal.frame, surface.least_share, surface.scan_sensor_mm, surface.surface_sensor_mm, surface.near};
}

void from_surface(const Scan& scan, FixtureCalibration& c) {
    constexpr std::size_t kSamples = 300000;  // of the nominal mesh; the fit takes a tenth as many places from them
    const NominalSurfaceFile& surface = c.nominal.surface;
    const Scan nominal = read_surface(surface.file, surface.unit, kSamples);
    BestFit fit = calibrate_surface(scan, nominal, c.nominal.work_points, search_options(c.nominal));
    c.frame = std::move(fit.frame);
    c.inputs.push_back({surface.file.string(), sha256_of_file(surface.file)});
    c.numbers = {{"noise of the scan", fit.scan_noise_mm, "mm"},
                 {"scatter about the nominal surface", fit.scale_mm, "mm"},
                 {"share of the nominal surface seen", fit.share_seen, ""},
                 {"points of the scan taken", static_cast<double>(fit.points_taken), ""},
                 {"variance over that of independent points", fit.correlation, ""}};
}

}  // namespace

FixtureCalibration calibrate_fixture(const fs::path& observations, const fs::path& nominal,
                                     const ReadOptions& read_options) {
    FixtureCalibration c;
    c.nominal = read_nominal_fixture(nominal);
    c.nominal.work_points = with_seams(std::move(c.nominal.work_points), c.nominal.seams);
    c.inputs.push_back({nominal.string(), sha256_of_file(nominal)});
    const fs::path measured = fs::is_directory(observations) ? observations / kSeamPoints : observations;
    c.inputs.push_back({measured.string(), sha256_of_file(measured)});
    switch (c.nominal.method) {
        case FixtureMethod::balls:
            c.scan = read(observations, read_options);
            from_balls(*c.scan, c);
            break;
        case FixtureMethod::points:
        case FixtureMethod::three_points:
            from_points(read_touched_points(observations, c.nominal.sigma_mm), c);
            break;
        case FixtureMethod::planes:
            if (c.nominal.probes) {
                c.scan = read(observations, read_options);
                from_probed_planes(*c.scan, c);
            } else {
                const std::string extension = observations.extension().string();
                if (extension == ".ply" || extension == ".pcd") {
                    throw InputError("planes: " + observations.string() +
                                     " is a scan: \"near\", about base_from_part, was needed to probe it");
                }
                from_planes(read_touched_points(observations, c.nominal.sigma_mm), c);
            }
            break;
        case FixtureMethod::best_fit:
            c.scan = read(observations, read_options);
            from_surface(*c.scan, c);
            break;
        case FixtureMethod::seams:
            from_seams(read_measured_seams(observations), c);
            break;
        case FixtureMethod::boards:
            c.frame = frame_from_boards(observations, c.nominal, c.numbers);
            if (c.nominal.boards.camera_file) {
                c.inputs.push_back(
                    {c.nominal.boards.camera_file->string(), sha256_of_file(*c.nominal.boards.camera_file)});
            }
            break;
    }
    return c;
}

void compare_with(const StoredFixture& accepted, FixtureCalibration& c) {
    if (accepted.name != c.nominal.name) {
        throw InputError("calibrate: the accepted calibration is of \"" + accepted.name + "\", this one of \"" +
                         c.nominal.name + "\"; give each fixture a folder of its own");
    }
    FrameChange change{
        accepted.date, displacement(accepted.base_from_part, c.frame.base_from_part), {}, c.nominal.change_limit_mm};
    for (const WorkPoint& w : c.nominal.work_points) {
        change.work_point_mm.push_back((c.frame.base_from_part * w.p - accepted.base_from_part * w.p).norm());
        if (change.work_point_mm.back() > change.limit_mm) {
            c.frame.faults.push_back("work point " + w.name + " has moved by " + fixed(change.work_point_mm.back(), 3) +
                                     " mm since the calibration accepted on " + accepted.date + "; the limit is " +
                                     shortest(change.limit_mm) + " mm");
        }
    }
    c.change = change;
}

}  // namespace seampath
