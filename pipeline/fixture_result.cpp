
#include <nlohmann/json.hpp>

#include "pipeline/files.hpp"
#include "pipeline/fixture_calibration.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/json_values.hpp"
#include "pipeline/text.hpp"
#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

constexpr std::size_t kMaxResultBytes = std::size_t{16} << 20;
constexpr const char* kKind = "fixture calibration";

Json features_json(const FrameResult& r) {
    Json list = Json::array();
    for (const FeatureResult& f : r.features) {
        Json row{{"name", f.name},
                 {"check", f.check},
                 {"place_mm", vector_json(f.place)},
                 {"residual_mm", f.residual_mm},
                 {"residual_sigma", f.residual_sigma},
                 {"shift_mm", vector_json(f.shift_mm)}};
        if (f.can_be_left_out) {
            row["leave_one_out_mm"] = f.leave_one_out_mm;
            row["p_value_without"] = f.without_p_value;
        }
        list.push_back(std::move(row));
    }
    return list;
}

Json weak_json(const FrameResult& r) {
    Json list = Json::array();
    for (const Weakness& w : r.weak) {
        Json row{{"text", w.text}, {"kind", w.turn ? "turn" : "shift"}, {"direction", vector_json(w.direction)}};
        if (w.turn) {
            row["centre_mm"] = vector_json(w.centre);
            row["pitch_mm_per_rad"] = w.pitch_mm;
        }
        row["share"] = w.share;
        list.push_back(std::move(row));
    }
    return list;
}

Json work_points_json(const FrameResult& r) {
    Json list = Json::array();
    for (const WorkPointResult& w : r.work_points) {
        list.push_back({{"name", w.name},
                        {"part_mm", vector_json(w.p)},
                        {"base_mm", vector_json(w.in_base)},
                        {"expanded_uncertainty_mm", w.expanded_mm},
                        {"covariance_mm2", matrix_json(w.covariance)}});
    }
    return list;
}

Json change_json(const FixtureCalibration& c) {
    if (!c.change) {
        return nullptr;
    }
    const Vector6& d = c.change->step;
    Json points = Json::array();
    for (std::size_t i = 0; i < c.change->work_point_mm.size(); ++i) {
        points.push_back({{"name", c.nominal.work_points[i].name}, {"moved_mm", c.change->work_point_mm[i]}});
    }
    return {{"since", c.change->since},
            {"x_mm", d[0]},
            {"y_mm", d[1]},
            {"z_mm", d[2]},
            {"rx_deg", d[3] / kDegree},
            {"ry_deg", d[4] / kDegree},
            {"rz_deg", d[5] / kDegree},
            {"work_points", std::move(points)},
            {"limit_mm", c.change->limit_mm}};
}

std::string yes_no(bool value) {
    return value ? "yes" : "";
}

}  // namespace

std::string fixture_result_json(const FixtureCalibration& c) {
    Json numbers = Json::array(), inputs = Json::array();
    for (const MethodNumber& n : c.numbers) {
        numbers.push_back({{"name", n.name}, {"value", n.value}, {"unit", n.unit}});
    }
    for (const InputFile& input : c.inputs) {
        inputs.push_back({{"file", input.file}, {"sha256", input.sha256}});
    }
    Json accepted;
    if (c.accepted) {
        accepted = {{"date", c.accepted->date}, {"reason", c.accepted->reason}};
    }
    const FrameResult& r = c.frame;
    const Json json{{"kind", kKind},
                    {"fixture", c.nominal.name},
                    {"method", kFixtureMethodNames[static_cast<std::size_t>(c.nominal.method)]},
                    {"date", c.date},
                    {"program", "seampath " SEAMPATH_VERSION},
                    {"verdict", r.pass() ? "pass" : "fail"},
                    {"faults", r.faults},
                    {"notes", r.notes},
                    {"base_from_part", pose_json(r.base_from_part)},
                    {"covariance",
                     {{"order", {"x_mm", "y_mm", "z_mm", "rx_rad", "ry_rad", "rz_rad"}},
                      {"meaning", "shift of the part's origin and turn about it, along the axes of base"},
                      {"values", matrix_json(r.covariance)}}},
                    {"features", features_json(r)},
                    {"moved", r.moved},
                    {"weak_directions", weak_json(r)},
                    {"redundancy", r.redundancy},
                    {"chi_squared", r.chi_squared},
                    {"p_value", r.p_value},
                    {"work_points", work_points_json(r)},
                    {"limit_mm", c.nominal.frame.limit_mm},
                    {"numbers", std::move(numbers)},
                    {"change", change_json(c)},
                    {"accepted", std::move(accepted)},
                    {"inputs", std::move(inputs)}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

StoredFixture read_fixture_result(const std::filesystem::path& file) {
    try {
        const Json json = parse_json(read_file(file, kMaxResultBytes, "calibrate"));
        StoredFixture s;
        if (json.at("kind") != kKind) {
            throw InputError("");
        }
        s.name = json.at("fixture").get<std::string>();
        s.date = json.at("date").get<std::string>();
        s.pass = json.at("verdict") == "pass";
        s.base_from_part.matrix() = matrix_of(json.at("base_from_part").at("matrix"), 4);
        s.covariance = matrix_of(json.at("covariance").at("values"), 6);
        if (!json.at("accepted").is_null()) {
            s.accepted = Acceptance{json.at("accepted").at("date").get<std::string>(),
                                    json.at("accepted").at("reason").get<std::string>()};
        }
        return s;
    } catch (const std::exception& error) {
        throw InputError("calibrate: " + file.string() +
                         " is no result of a fixture calibration; one that \"seampath calibrate fixture\" wrote was "
                         "needed (" +
                         std::string(error.what()) + ")");
    }
}

std::string fixture_result_text(const FixtureCalibration& c) {
    const FrameResult& r = c.frame;
    const Vector3d p = r.base_from_part.translation();
    const Eigen::Quaterniond q(r.base_from_part.linear());
    std::string text = c.nominal.name + ": " + (r.pass() ? "pass" : "fail") + "\n";
    for (const auto& fault : r.faults) {
        text += "  " + fault + "\n";
    }
    for (const auto& note : r.notes) {
        text += "  note: " + note + "\n";
    }
    text += "\nbase from part, mm and quaternion w x y z:\n  " + fixed(p.x(), 4) + " " + fixed(p.y(), 4) + " " +
            fixed(p.z(), 4) + "   " + fixed(q.w(), 8) + " " + fixed(q.x(), 8) + " " + fixed(q.y(), 8) + " " +
            fixed(q.z(), 8) + "\n\n";
    Rows rows{{"feature", "residual mm", "in sigma", "without it mm", "check"}};
    for (const FeatureResult& f : r.features) {
        rows.push_back({f.name, fixed(f.residual_mm, 4), fixed(f.residual_sigma, 2),
                        f.can_be_left_out ? fixed(f.leave_one_out_mm, 4) : "-", yes_no(f.check)});
    }
    text += aligned(rows) + "\n";
    rows = {{"work point", "x", "y", "z", "expanded uncertainty mm", "moved mm"}};
    for (std::size_t i = 0; i < r.work_points.size(); ++i) {
        const WorkPointResult& w = r.work_points[i];
        rows.push_back({w.name, fixed(w.in_base.x(), 3), fixed(w.in_base.y(), 3), fixed(w.in_base.z(), 3),
                        fixed(w.expanded_mm, 4), c.change ? fixed(c.change->work_point_mm[i], 4) : "-"});
    }
    text += aligned(rows);
    for (const MethodNumber& n : c.numbers) {
        text += n.name + ": " + shortest(n.value) + (n.unit.empty() ? "" : " " + n.unit) + "\n";
    }
    return text;
}

}  // namespace seampath
