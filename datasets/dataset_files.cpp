#include <array>
#include <bit>
#include <fstream>
#include <span>
#include <string_view>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "datasets/dataset.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

using nlohmann::ordered_json;
using Member = Eigen::Vector3d TruthPoint::*;

constexpr int kTruthVersion = 1;
constexpr std::array<std::pair<const char*, Member>, 4> kColumns{{{"points_mm", &TruthPoint::p},
                                                                  {"tangents", &TruthPoint::tangent},
                                                                  {"n1", &TruthPoint::n1},
                                                                  {"n2", &TruthPoint::n2}}};

ordered_json to_json(const Fields& fields) {
    ordered_json object = ordered_json::object();
    for (const Field& field : fields) {
        const std::string key(field.key);
        std::visit(
            [&](const auto& value) {
                using T = std::decay_t<decltype(value)>;
                if constexpr (std::is_same_v<T, Choice>) {
                    object[key] = value.names[static_cast<std::size_t>(value.get())];
                } else if constexpr (std::is_same_v<T, std::optional<double>*>) {
                    object[key] = *value ? ordered_json(**value) : ordered_json();
                } else {
                    object[key] = *value;
                }
            },
            field.value);
    }
    return object;
}

ordered_json to_json(const TruthSeam& seam) {
    ordered_json object{{"closed", seam.closed}};
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

ordered_json to_json(const Dataset& dataset) {
    SceneOptions scene = dataset.scene;
    ScannerOptions scanner = dataset.scanner;
    const Eigen::Quaterniond q(dataset.scan_from_scene.linear());
    const Eigen::Vector3d t = dataset.scan_from_scene.translation();
    ordered_json seams = ordered_json::array();
    for (const TruthSeam& seam : dataset.truth.seams) {
        seams.push_back(to_json(seam));
    }
    return {{"format", "seampath truth"},
            {"version", kTruthVersion},
            {"seed", dataset.seed},
            {"scene", to_json(describe(scene))},
            {"scanner", to_json(describe(scanner))},
            {"scan_from_scene", {{"xyz_mm", {t.x(), t.y(), t.z()}}, {"qwxyz", {q.w(), q.x(), q.y(), q.z()}}}},
            {"seams", std::move(seams)}};
}

/// Under another name first, so that a file of the right name is always whole.
void write_file(const std::filesystem::path& file, std::span<const std::string_view> parts) {
    std::filesystem::path unfinished = file;
    unfinished += ".tmp";
    std::ofstream out(unfinished, std::ios::binary);
    for (const std::string_view part : parts) {
        out.write(part.data(), static_cast<std::streamsize>(part.size()));
    }
    out.close();
    std::error_code error;
    if (out) {
        std::filesystem::rename(unfinished, file, error);
    }
    if (!out || error) {
        std::error_code ignored;
        std::filesystem::remove(unfinished, ignored);
        throw InputError("dataset: can't write " + file.string() + "; choose a folder that is writable and not full");
    }
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

std::string ply_header(const Dataset& dataset) {
    return "ply\nformat binary_little_endian 1.0\ncomment lengths in mm\nelement vertex " +
           std::to_string(dataset.points.size()) +
           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
}

std::string pcd_header(const Dataset& dataset) {
    return "# .PCD v0.7 - lengths in mm\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
           std::to_string(dataset.width) + "\nHEIGHT " + std::to_string(dataset.height) +
           "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(dataset.points.size()) + "\nDATA binary\n";
}

}  // namespace

void write_dataset(const Dataset& dataset, const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    static_assert(sizeof(Eigen::Vector3f) == 12 && std::endian::native == std::endian::little);
    const bool organised = dataset.width > 0;
    const std::string header = organised ? pcd_header(dataset) : ply_header(dataset);
    const std::string_view body(reinterpret_cast<const char*>(dataset.points.data()), dataset.points.size() * 12);
    write_file(folder / (organised ? "scan.pcd" : "scan.ply"), std::array<std::string_view, 2>{header, body});
    write_file(folder / "truth.json", std::array<std::string_view, 1>{to_json(dataset).dump() + "\n"});
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
            truth.seams.push_back({seam.at("closed").get<bool>(), read_points(seam)});
        }
        return truth;
    } catch (const ordered_json::exception& problem) {
        throw InputError("dataset: " + file.string() + " is not a truth file: " + problem.what() +
                         "; make the data set again");
    }
}

}  // namespace seampath
