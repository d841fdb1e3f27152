#include <algorithm>
#include <array>
#include <bit>
#include <fstream>

#include <nlohmann/json.hpp>

#include "datasets/dataset.hpp"
#include "pipeline/fields.hpp"
#include "pipeline/files.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using nlohmann::ordered_json;
using Member = Eigen::Vector3d TruthPoint::*;

constexpr int kTruthVersion = 1;
constexpr std::array<std::pair<const char*, Member>, 4> kColumns{{{"points_mm", &TruthPoint::p},
                                                                  {"tangents", &TruthPoint::tangent},
                                                                  {"n1", &TruthPoint::n1},
                                                                  {"n2", &TruthPoint::n2}}};

constexpr std::array<std::pair<const char*, double Groove::*>, 8> kGrooveKeys{
    {{"gap_mm", &Groove::gap_mm},
     {"mismatch_mm", &Groove::mismatch_mm},
     {"root_face_mm", &Groove::root_face_mm},
     {"depth_mm", &Groove::depth_mm},
     {"bevel_1_deg", &Groove::bevel_1_deg},
     {"bevel_2_deg", &Groove::bevel_2_deg},
     {"included_angle_deg", &Groove::included_angle_deg},
     {"area_mm2", &Groove::area_mm2}}};

ordered_json to_json(const TruthSeam& seam) {
    ordered_json object{{"closed", seam.closed}, {"kind", name(seam.kind)}};
    if (seam.groove) {
        for (const auto& [key, member] : kGrooveKeys) {
            object["groove"][key] = (*seam.groove).*member;
        }
    }
    for (const auto& [key, member] : kColumns) {
        ordered_json rows = ordered_json::array();
        for (const TruthPoint& point : seam.points) {
            const Eigen::Vector3d& v = point.*member;
            rows.push_back({v.x(), v.y(), v.z()});
        }
        object[key] = std::move(rows);
    }
    return object;
}

ordered_json to_json(const DatasetView& view) {
    ordered_json rows = ordered_json::array();
    for (int row = 0; row < 3; ++row) {
        const auto& m = view.error.matrix();
        rows.push_back({m(row, 0), m(row, 1), m(row, 2), m(row, 3)});
    }
    return {{"first_point", view.first_point}, {"error", std::move(rows)}};
}

ordered_json to_json(const Dataset& dataset) {
    SceneOptions scene = dataset.scene;
    ScannerOptions scanner = dataset.scanner;
    const Eigen::Quaterniond q(dataset.scan_from_scene.linear());
    const Eigen::Vector3d t = dataset.scan_from_scene.translation();
    ordered_json seams = ordered_json::array();
    for (const TruthSeam& seam : dataset.truth.seams) {
        seams.push_back(to_json(seam));
    }
    ordered_json views = ordered_json::array();
    for (const DatasetView& view : dataset.views) {
        views.push_back(to_json(view));
    }
    return {{"format", "seampath truth"},
            {"version", kTruthVersion},
            {"seed", dataset.seed},
            {"scene", fields_json(describe(scene))},
            {"scanner", fields_json(describe(scanner))},
            {"scan_from_scene", {{"xyz_mm", {t.x(), t.y(), t.z()}}, {"qwxyz", {q.w(), q.x(), q.y(), q.z()}}}},
            {"views", std::move(views)},
            {"seams", std::move(seams)}};
}

std::vector<TruthPoint> read_points(const ordered_json& seam) {
    std::vector<TruthPoint> points(seam.at(kColumns[0].first).size());
    for (const auto& [key, member] : kColumns) {
        const ordered_json& rows = seam.at(key);
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                (points[i].*member)[axis] = rows.at(i).at(static_cast<std::size_t>(axis)).get<double>();
            }
        }
    }
    return points;
}

JointKind read_kind(const ordered_json& kind) {
    const auto found = std::find(kJointKindNames.begin(), kJointKindNames.end(), kind.get<std::string>());
    if (found == kJointKindNames.end()) {
        throw InputError("dataset: there is no joint kind " + kind.dump() + "; there are " + join(kJointKindNames));
    }
    return static_cast<JointKind>(found - kJointKindNames.begin());
}

TruthSeam read_seam(const ordered_json& json) {
    TruthSeam seam{json.at("closed").get<bool>(), read_points(json), JointKind::fillet, {}};
    if (json.contains("kind")) {  // files of before there were other joints have none
        seam.kind = read_kind(json.at("kind"));
    }
    if (json.contains("groove")) {
        Groove groove;
        for (const auto& [key, member] : kGrooveKeys) {
            groove.*member = json.at("groove").at(key).get<double>();
        }
        seam.groove = groove;
    }
    return seam;
}

/// "mm", or "units of 25.4 mm"
std::string unit_text(double mm_per_unit) {
    return mm_per_unit == 1 ? "mm" : "units of " + shortest(mm_per_unit) + " mm";
}

std::string ply_header(const Dataset& dataset, double mm_per_unit) {
    return "ply\nformat binary_little_endian 1.0\ncomment lengths in " + unit_text(mm_per_unit) + "\nelement vertex " +
           std::to_string(dataset.points.size()) +
           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
}

std::string pcd_header(const Dataset& dataset, double mm_per_unit) {
    return "# .PCD v0.7 - lengths in " + unit_text(mm_per_unit) +
           "\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + std::to_string(dataset.width) +
           "\nHEIGHT " + std::to_string(dataset.height) + "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
           std::to_string(dataset.points.size()) + "\nDATA binary\n";
}

}  // namespace

std::filesystem::path write_dataset(const Dataset& dataset, const std::filesystem::path& folder, double mm_per_unit) {
    static_assert(sizeof(Eigen::Vector3f) == 12 && std::endian::native == std::endian::little);
    const bool organised = dataset.width > 0;
    std::string scan = organised ? pcd_header(dataset, mm_per_unit) : ply_header(dataset, mm_per_unit);
    std::vector<Eigen::Vector3f> points = dataset.points;
    if (mm_per_unit != 1) {
        for (Eigen::Vector3f& p : points) {
            p = (p.cast<double>() / mm_per_unit).cast<float>();
        }
    }
    scan.append(reinterpret_cast<const char*>(points.data()), points.size() * sizeof(Eigen::Vector3f));
    const char* const name = organised ? "scan.pcd" : "scan.ply";
    const RunFolder files(folder);
    files.write(name, scan);
    files.write("truth.json", to_json(dataset).dump() + "\n");
    return folder / name;
}

Truth read_truth(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) {
        throw InputError("dataset: can't open " + file.string() +
                         "; name a truth.json that `seampath dataset make` wrote");
    }
    try {
        const ordered_json json = ordered_json::parse(in);
        if (json.at("format") != "seampath truth" || json.at("version") != kTruthVersion) {
            throw InputError("dataset: " + file.string() + " is not a truth file of version " +
                             std::to_string(kTruthVersion) + "; make the data set again");
        }
        Truth truth;
        for (const ordered_json& seam : json.at("seams")) {
            truth.seams.push_back(read_seam(seam));
        }
        return truth;
    } catch (const ordered_json::exception& problem) {
        throw InputError("dataset: " + file.string() + " is not a truth file: " + problem.what() +
                         "; make the data set again");
    }
}

}  // namespace seampath
