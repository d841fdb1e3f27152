#include "pipeline/fixture_nominal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <nlohmann/json.hpp>

#include "pipeline/camera_json.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
constexpr std::array<std::string_view, 2> kWeakNames{"refuse", "freeze"};

/// One object of the file: values by key, and what is wrong with them.
class Object {
public:
    Object(const Json& json, std::string path, std::vector<std::string>& problems)
        : json_(json), path_(std::move(path)), problems_(problems) {
        if (!json_.is_object()) {
            problem("", json_excerpt(json_) + " is not an object");
        }
    }

    bool has(const std::string& key) const { return json_.is_object() && json_.contains(key); }

    const Json* take(const std::string& key, bool needed) {
        known_.push_back(key);
        if (has(key)) {
            return &json_.at(key);
        }
        if (needed && json_.is_object()) {
            problem(key, "is missing");
        }
        return nullptr;
    }

    std::string text(const std::string& key, bool needed) {
        const Json* value = take(key, needed);
        if (value && (!value->is_string() || value->get<std::string>().empty())) {
            problem(key, json_excerpt(*value) + " is no text");
        }
        return value && value->is_string() ? value->get<std::string>() : "";
    }

    void number(const std::string& key, bool needed, double& target, double low, bool open = true,
                double high = std::numeric_limits<double>::max()) {
        const Json* value = take(key, needed);
        if (!value) {
            return;
        }
        const double v = value->is_number() ? value->get<double>() : NAN;
        if (!std::isfinite(v) || v < low || (open && v == low) || v > high) {
            const bool bounded = high < std::numeric_limits<double>::max();
            problem(key, json_excerpt(*value) + " is no number " + (open ? "above " : "of at least ") +
                             Json(low).dump() + (bounded ? " and at most " + Json(high).dump() : ""));
            return;
        }
        target = v;
    }

    Vector3d vector(const std::string& key) {
        const Json* value = take(key, true);
        return value ? vector_of(key, *value) : Vector3d::Zero();
    }

    std::vector<Vector3d> vectors(const std::string& key) {
        const Json* list = take(key, true);
        if (list && !list->is_array()) {
            problem(key, json_excerpt(*list) + " is no list");
        }
        std::vector<Vector3d> all;
        for (std::size_t i = 0; list && list->is_array() && i < list->size(); ++i) {
            all.push_back(vector_of(key + "/" + std::to_string(i), (*list)[i]));
        }
        return all;
    }

    bool flag(const std::string& key) {
        const Json* value = take(key, false);
        if (value && !value->is_boolean()) {
            problem(key, json_excerpt(*value) + " is neither true nor false");
        }
        return value && value->is_boolean() && value->get<bool>();
    }

    std::optional<Vector3d> vector_if_given(const std::string& key) {
        return has(key) ? std::optional(vector(key)) : std::nullopt;
    }

    template <class F>
    void each(const std::string& key, bool needed, const F& f) {
        const Json* list = take(key, needed);
        if (list && !list->is_array()) {
            problem(key, json_excerpt(*list) + " is no list");
        } else if (list) {
            for (std::size_t i = 0; i < list->size(); ++i) {
                Object object((*list)[i], path_ + "/" + key + "/" + std::to_string(i), problems_);
                f(object);
                object.finish();
            }
        }
    }

    template <std::size_t N>
    std::size_t choice(const std::string& key, bool needed, const std::array<std::string_view, N>& names,
                       std::size_t otherwise) {
        const std::string word = text(key, needed);
        const auto found = std::find(names.begin(), names.end(), word);
        if (!word.empty() && found == names.end()) {
            problem(key, "\"" + word + "\" is unknown; there are " + join(names) + hint(word, names));
        }
        return found == names.end() ? otherwise : static_cast<std::size_t>(found - names.begin());
    }

    /// An object of these members alone.
    Json part(const std::vector<std::string>& keys) {
        Json object = Json::object();
        for (const std::string& key : keys) {
            if (const Json* value = take(key, false)) {
                object[key] = *value;
            }
        }
        return object;
    }

    std::vector<std::string>& problems() { return problems_; }

    void problem(const std::string& key, const std::string& what) {
        problems_.push_back(path_ + (key.empty() ? "" : "/" + key) + ": " + what);
    }

    void finish() {
        if (!json_.is_object()) {
            return;
        }
        const std::vector<std::string_view> known(known_.begin(), known_.end());
        for (const auto& [key, value] : json_.items()) {
            if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
                const std::string near = hint(key, known);
                problem(key, "there is no such key" + (near.empty() ? "; there are " + join(known) : near));
            }
        }
    }

private:
    Vector3d vector_of(const std::string& key, const Json& value) {
        const bool three = value.is_array() && value.size() == 3 &&
                           std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_number(); });
        if (!three) {
            problem(key, json_excerpt(value) + " is no vector; [x, y, z] was needed");
        }
        return three ? Vector3d(value[0], value[1], value[2]) : Vector3d::Zero();
    }

    const Json& json_;
    std::string path_;
    std::vector<std::string>& problems_;
    std::vector<std::string> known_;
};

NamedPoint point_of(Object& object) {
    return {object.text("name", true), object.vector("p_mm")};
}

NominalPlane plane_of(Object& object) {
    NominalPlane plane;
    plane.name = object.text("name", true);
    plane.normal = object.vector("normal");
    if (plane.normal.norm() > 0) {
        plane.normal.normalize();
    } else {
        object.problem("normal", "has no direction");
    }
    object.number("offset_mm", true, plane.offset_mm, -1e9);
    object.each("points", true, [&](Object& point) { plane.points.push_back(point_of(point)); });
    return plane;
}

void check_names(Object& root, const std::string& key, const std::vector<std::string>& names) {
    std::set<std::string> seen;
    for (const auto& name : names) {
        if (!name.empty() && !seen.insert(name).second) {
            root.problem(key, "the name \"" + name + "\" stands twice");
        }
    }
}

NominalSeam seam_of(Object& object) {
    NominalSeam seam;
    seam.name = object.text("name", true);
    seam.closed = object.flag("closed");
    seam.points = object.vectors("points_mm");
    return seam;
}

std::optional<Eigen::Isometry3d> near_of(Object& root) {
    const Json near = root.part({"near"});
    return near.empty() ? std::nullopt
                        : std::optional(pose_from(JsonObject(near, "", root.problems(), {"near"}), "near"));
}

std::optional<ProbeOptions> probes_of(Object& root) {
    const auto near = near_of(root);
    ProbeOptions probes;
    probes.near = near.value_or(probes.near);
    root.number("patch_mm", false, probes.patch_mm, 0);
    root.number("search_mm", false, probes.search_mm, 0);
    return near ? std::optional(probes) : std::nullopt;
}

NominalSurfaceFile surface_of(Object& root, const std::filesystem::path& folder) {
    NominalSurfaceFile surface;
    root.number("least_share", false, surface.least_share, 0, true, 1);
    surface.scan_sensor_mm = root.vector_if_given("sensor_mm");
    surface.near = near_of(root);
    surface.file = folder / root.text("surface", true);
    surface.unit = static_cast<Unit>(root.choice("surface_unit", false, kUnitNames, 0));
    surface.surface_sensor_mm = root.vector_if_given("surface_sensor_mm");
    return surface;
}

// What the method needs beside what all take.
void read_method(Object& root, const std::filesystem::path& folder, NominalFixture& n) {
    std::vector<std::string> names;
    switch (n.method) {
        case FixtureMethod::balls:
            root.number("ball_diameter_mm", true, n.ball_diameter_mm, 0);
            root.number("match_tolerance_mm", false, n.match_tolerance_mm, 0);
            root.each("balls", true, [&](Object& o) { n.features.push_back(point_of(o)); });
            break;
        case FixtureMethod::points:
        case FixtureMethod::three_points:
            root.number("sigma_mm", false, n.sigma_mm, 0);
            root.each("points", true, [&](Object& o) { n.features.push_back(point_of(o)); });
            break;
        case FixtureMethod::planes:
            if (!root.has("near")) {
                root.number("sigma_mm", false, n.sigma_mm, 0);
            }
            root.each("planes", true, [&](Object& o) { n.planes.push_back(plane_of(o)); });
            n.probes = probes_of(root);
            break;
        case FixtureMethod::best_fit:
            n.surface = surface_of(root, folder);
            break;
        case FixtureMethod::seams:
            break;
        case FixtureMethod::boards:
            n.boards = nominal_boards(root.part({"boards", "camera", "base_from_camera"}), folder, root.problems());
            break;
    }
    root.each("seams", n.method == FixtureMethod::seams, [&](Object& o) { n.seams.push_back(seam_of(o)); });
    for (const NamedPoint& feature : n.features) {
        names.push_back(feature.name);
    }
    for (const NominalSeam& seam : n.seams) {
        names.push_back(seam.name);
    }
    for (const NominalBoard& board : n.boards.boards) {
        names.push_back(board.name);
    }
    for (const NominalPlane& plane : n.planes) {
        for (const NamedPoint& point : plane.points) {
            names.push_back(point.name);
        }
    }
    constexpr std::array<const char*, kFixtureMethodNames.size()> kNamed{"balls",   "points", "points", "points",
                                                                         "surface", "seams",  "boards"};
    check_names(root, kNamed[static_cast<std::size_t>(n.method)], names);
}

}  // namespace

NominalFixture read_nominal_fixture(const std::filesystem::path& file) {
    NominalFixture n;
    n.frame.weak_ratio = 1e-5;
    std::vector<std::string> problems;
    try {
        const Json json = parse_json(read_file(file, kMaxBytes, "nominal"));
        Object root(json, "", problems);
        n.name = root.text("name", true);
        n.method = static_cast<FixtureMethod>(root.choice("method", true, kFixtureMethodNames, 0));
        if (problems.empty()) {
            read_method(root, file.parent_path(), n);
            root.each("work_points", false, [&](Object& o) {
                const NamedPoint p = point_of(o);
                n.work_points.push_back({p.name, p.p});
            });
            root.number("limit_mm", false, n.frame.limit_mm, 0);
            root.number("change_limit_mm", false, n.change_limit_mm, 0);
            n.frame.weak = static_cast<WeakDirection>(root.choice("weak_directions", false, kWeakNames, 0));
            double trials = n.frame.trials, seed = 1;
            root.number("trials", false, trials, 1000, false);
            root.number("seed", false, seed, 0, false);
            n.frame.trials = static_cast<int>(std::min(trials, 1e6));
            n.frame.seed = static_cast<std::uint64_t>(seed);
            root.finish();
        }
    } catch (const JsonError& error) {
        problems.push_back(std::string("/: ") + error.what());
    }
    if (!problems.empty()) {
        std::string text;
        for (const auto& problem : problems) {
            text += (text.empty() ? "" : "\n") + file.string() + ": " + problem;
        }
        throw InputError(text);
    }
    if (n.work_points.empty()) {
        n.work_points.push_back({"origin of the part", Vector3d::Zero()});
    }
    return n;
}

}  // namespace seampath
