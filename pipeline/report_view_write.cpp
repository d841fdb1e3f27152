#include <algorithm>
#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "pipeline/report_text.hpp"
#include "pipeline/report_view.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

/// Steps between the two corners of a cloud: 5 micrometres on 300 mm.
constexpr float kSteps = 65535;

/// The still picture: its size in CSS pixels, and how many points it shows of each cloud.
constexpr double kViewWidth = 1200, kViewHeight = 640;
constexpr std::size_t kStillPoints = 6000;

/// Coordinates in the page: a tenth of a micrometre.
double trimmed(double mm) {
    return std::round(mm * 1e4) / 1e4;
}

Json trimmed_json(const Eigen::Vector3d& v) {
    return {trimmed(v.x()), trimmed(v.y()), trimmed(v.z())};
}

Json camera_json(const ViewCamera& camera) {
    return {{"toward", trimmed_json(camera.toward)}, {"up", trimmed_json(camera.up)}};
}

Json cloud_json(const ViewCloud& cloud) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& p : cloud.points) {
        box.extend(p);
    }
    const Eigen::Vector3f low = box.isEmpty() ? Eigen::Vector3f::Zero() : box.min();
    const Eigen::Vector3f size = box.isEmpty() ? Eigen::Vector3f::Ones() : Eigen::Vector3f(box.sizes().cwiseMax(1e-3F));
    std::string positions, normals;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        const Eigen::Vector3f share = (cloud.points[i] - low).cwiseQuotient(size);
        for (int k = 0; k < 3; ++k) {
            const auto step = static_cast<unsigned>(std::lround(share[k] * kSteps));
            positions += static_cast<char>(step & 0xff);
            positions += static_cast<char>(step >> 8);
            normals += static_cast<char>(std::lround(cloud.normals[i][k] * 127));
        }
    }
    return {{"count", cloud.points.size()},
            {"low", trimmed_json(low.cast<double>())},
            {"size", trimmed_json(size.cast<double>())},
            {"spacing", trimmed(static_cast<double>(cloud.spacing_mm))},
            {"positions", base64(positions)},
            {"normals", base64(normals)}};
}

Json seam_json(const ViewSeam& seam) {
    Json samples = Json::array(), nodes = Json::array();
    for (const ViewSample& s : seam.samples) {
        samples.push_back({trimmed(s.p.x()), trimmed(s.p.y()), trimmed(s.p.z()), trimmed(s.station_mm),
                           s.covered ? Json(trimmed(s.distance_mm)) : Json(), trimmed(s.sigma_mm), s.modelled ? 1 : 0,
                           trimmed(s.flank1_mm), trimmed(s.flank2_mm)});
    }
    for (const Eigen::Vector3d& node : seam.nodes) {
        nodes.push_back(trimmed_json(node));
    }
    return {{"tolerance", seam.tolerance_mm},
            {"camera", camera_json(seam.camera)},
            {"samples", std::move(samples)},
            {"nodes", std::move(nodes)}};
}

Json mark_json(const ViewMark& mark) {
    return {{"text", valid_utf8(mark.text)},
            {"p", trimmed_json(mark.p)},
            {"arrow", trimmed_json(mark.arrow)},
            {"good", mark.good}};
}

Json ellipsoid_json(const ViewEllipsoid& e) {
    return {{"text", valid_utf8(e.text)},
            {"p", trimmed_json(e.p)},
            {"axes",
             {trimmed_json(e.half_axes.col(0)), trimmed_json(e.half_axes.col(1)), trimmed_json(e.half_axes.col(2))}},
            {"good", e.good}};
}

/// Parallel projection onto the page.
struct Projection {
    Eigen::Vector3d right, up, toward;
    double scale;

    explicit Projection(const ViewScene& scene)
        : right(scene.camera.up.cross(scene.camera.toward)),
          up(scene.camera.up),
          toward(scene.camera.toward),
          scale(0.5 * kViewHeight / scene.radius_mm) {}

    Eigen::Vector3d operator()(const Eigen::Vector3d& p) const {
        return {kViewWidth / 2 + scale * right.dot(p), kViewHeight / 2 - scale * up.dot(p), toward.dot(p)};
    }
};

std::string place(const Eigen::Vector3d& p) {
    return decimal(p.x(), 0) + ' ' + decimal(p.y(), 0);
}

std::string colour(const ViewScene& scene, const ViewSeam& seam, const ViewSample& sample) {
    if (!sample.covered || sample.modelled) {
        return kUncheckedColour;
    }
    if (sample.distance_mm > seam.tolerance_mm) {
        return kOutOfToleranceColour;
    }
    const double share = scene.scale_mm > 0 ? sample.distance_mm / scene.scale_mm : 0;
    const auto last = static_cast<double>(kDeviationColours.size() - 1);
    return kDeviationColours[static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * last))];
}

/// The cloud as dots in four greys by the slope of the surface, one path each.
std::string still_cloud(const ViewCloud& cloud, const Projection& project) {
    std::array<std::string, 4> paths;
    const Eigen::Vector3d light = (project.toward + 0.5 * project.up + 0.3 * project.right).normalized();
    const double share =
        static_cast<double>(kStillPoints) / static_cast<double>(std::max(kStillPoints, cloud.points.size()));
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        // Multiples of the golden ratio, modulo one, are even and follow no raster.
        const double turns = static_cast<double>(i) * std::numbers::phi;
        if (turns - std::floor(turns) >= share) {
            continue;
        }
        const Eigen::Vector3d p = project(cloud.points[i].cast<double>());
        if (p.x() > 0 && p.x() < kViewWidth && p.y() > 0 && p.y() < kViewHeight) {
            const double shade = std::abs(cloud.normals[i].cast<double>().dot(light));
            paths[std::min<std::size_t>(3, static_cast<std::size_t>(4 * shade))].append("M").append(place(p)).append(
                "h0");
        }
    }
    std::string svg;
    for (std::size_t k = 0; k < paths.size(); ++k) {
        svg += "<path class=\"dots shade" + std::to_string(k) + "\" d=\"" + paths[k] + "\"/>";
    }
    return svg;
}

/// Runs of one colour as one line each.
std::string still_seam(const ViewScene& scene, const ViewSeam& seam, const Projection& project) {
    std::string svg;
    for (std::size_t i = 0; i + 1 < seam.samples.size();) {
        const std::string stroke = colour(scene, seam, seam.samples[i]);
        std::string path = 'M' + place(project(seam.samples[i].p));
        while (i + 1 < seam.samples.size() && colour(scene, seam, seam.samples[i]) == stroke) {
            path.append("L").append(place(project(seam.samples[++i].p)));
        }
        svg.append("<path class=\"still-seam\" stroke=\"").append(stroke).append("\" d=\"").append(path).append("\"/>");
    }
    return svg;
}

std::string still_mark(const ViewMark& mark, const Projection& project) {
    return "<path class=\"still-mark" + std::string(mark.good ? "" : " bad") + "\" d=\"M" + place(project(mark.p)) +
           "m-6 0h12m-6 -6v12M" + place(project(mark.p)) + 'L' + place(project(mark.p + mark.arrow)) + "\"/>";
}

/// The outline of an ellipsoid x = p + H u, |u| = 1, in the projection along d: where u . H^-1 d = 0.
std::string still_ellipsoid(const ViewEllipsoid& e, const Projection& project) {
    constexpr int kCorners = 48;
    const Eigen::Vector3d n = (e.half_axes.inverse() * project.toward).normalized(), a = n.unitOrthogonal(),
                          b = n.cross(a);
    std::string path;
    for (int i = 0; i < kCorners; ++i) {
        const double turn = 2 * std::numbers::pi * i / kCorners;
        const Eigen::Vector3d u = std::cos(turn) * a + std::sin(turn) * b;
        path += (i == 0 ? 'M' : 'L') + place(project(e.p + e.half_axes * u));
    }
    return "<path class=\"still-mark" + std::string(e.good ? "" : " bad") + "\" d=\"" + path + "Z\"/>";
}

}  // namespace

std::string view_json(const ViewScene& scene) {
    Json clouds = Json::array(), seams = Json::array(), torch = Json::array(), colours = Json::array(),
         signed_colours = Json::array();
    for (const ViewCloud& cloud : scene.clouds) {
        clouds.push_back(cloud_json(cloud));
    }
    for (const ViewSeam& seam : scene.seams) {
        seams.push_back(seam_json(seam));
    }
    for (const ViewTorch& pose : scene.torch) {
        torch.push_back({trimmed_json(pose.p), trimmed_json(pose.axis)});
    }
    for (const char* stop : kDeviationColours) {
        colours.push_back(stop);
    }
    for (const char* stop : kSignedColours) {
        signed_colours.push_back(stop);
    }
    Json marks = Json::array(), ellipsoids = Json::array();
    for (const ViewMark& mark : scene.marks) {
        marks.push_back(mark_json(mark));
    }
    for (const ViewEllipsoid& e : scene.ellipsoids) {
        ellipsoids.push_back(ellipsoid_json(e));
    }
    const Json json{{"radius", scene.radius_mm},
                    {"camera", camera_json(scene.camera)},
                    {"scale", scene.scale_mm},
                    {"colours", std::move(colours)},
                    {"signedColours", std::move(signed_colours)},
                    {"outOfTolerance", kOutOfToleranceColour},
                    {"unchecked", kUncheckedColour},
                    {"clouds", std::move(clouds)},
                    {"seams", std::move(seams)},
                    {"torch", std::move(torch)},
                    {"marks", std::move(marks)},
                    {"ellipsoids", std::move(ellipsoids)}};
    return json.dump();
}

std::string view_svg(const ViewScene& scene) {
    const Projection project(scene);
    std::string svg = "<svg class=\"still\" role=\"img\" viewBox=\"0 0 " + decimal(kViewWidth, 0) + ' ' +
                      decimal(kViewHeight, 0) + "\"><title>" +
                      std::string(scene.seams.empty() ? "The part" : "Scan and seams, seen from the air side") +
                      "</title>";
    svg += still_cloud(scene.clouds[1], project) + still_cloud(scene.clouds[0], project);
    for (const ViewSeam& seam : scene.seams) {
        svg += still_seam(scene, seam, project);
    }
    for (const ViewMark& mark : scene.marks) {
        svg += still_mark(mark, project);
    }
    for (const ViewEllipsoid& e : scene.ellipsoids) {
        svg += still_ellipsoid(e, project);
    }
    return svg + "</svg>\n";
}

}  // namespace seampath
