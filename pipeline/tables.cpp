#include "pipeline/tables.hpp"

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <optional>

#include <nlohmann/json.hpp>

#include "pipeline/digest.hpp"
#include "pipeline/groove_columns.hpp"
#include "pipeline/report_text.hpp"
#include "stages/angle.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

void append(std::string& line, std::initializer_list<double> values) {
    for (const double value : values) {
        line += ',';
        line += shortest(value);
    }
}

Json position_json(const Eigen::Vector3d& p) {
    return {p.x(), p.y(), p.z()};
}

Json positions_json(const std::vector<Eigen::Vector3d>& points) {
    Json list = Json::array();
    for (const auto& p : points) {
        list.push_back(position_json(p));
    }
    return list;
}

void put_estimate(Json& json, const std::string& name, const std::string& unit, const std::optional<Measured>& estimate,
                  double factor = 1) {
    if (estimate) {
        json[name + "_" + unit] = factor * estimate->value;
        json[name + "_sigma_" + unit] = factor * estimate->sigma;
    }
}

Json saddle_json(const SaddleParameters& saddle) {
    Json json{{"header", name(saddle.header)}};
    put_estimate(json, "branch_radius", "mm", saddle.branch_radius_mm);
    put_estimate(json, "header_radius", "mm", saddle.header_radius_mm);
    put_estimate(json, "angle", "deg", saddle.angle_rad, 180 / std::numbers::pi);
    put_estimate(json, "offset", "mm", saddle.offset_mm);
    return json;
}

/// How many derivatives are continuous at each inner knot, and how far the seam may be from the curve in 19 of 20
/// cases.
void put_quality(Json& json, const SeamModel& model) {
    json["inner_knots_mm"] = Json::array();
    json["inner_knots_continuity"] = Json::array();
    for (const CurveKnot& knot : knots_of(model.curve)) {
        json["inner_knots_mm"].push_back(knot.u);
        json["inner_knots_continuity"].push_back(knot.continuity);
    }
    json["band_95_stations_mm"] = Json::array();
    json["band_95_half_width_mm"] = Json::array();
    for (const BandSample& sample : model.band) {
        json["band_95_stations_mm"].push_back(sample.station_mm);
        json["band_95_half_width_mm"].push_back(sample.half_width_mm);
    }
}

Json model_json(const SeamModel& model) {
    Json json{{"name", model.model},
              {"reason", model.reason},
              {"saddle", model.saddle ? saddle_json(*model.saddle) : Json()},
              {"type", "cubic_b_spline"},
              {"periodic", model.curve.periodic},
              {"knots_mm", model.curve.knots},
              {"control_points_mm", positions_json(model.curve.control)},
              {"residual_rms_mm", model.residual_rms_mm},
              {"residual_max_mm", model.residual_max_mm},
              {"degrees_of_freedom", model.degrees_of_freedom},
              {"corners_mm", model.corners_mm}};
    put_quality(json, model);
    return json;
}

Json nodes_json(const Nodes& nodes, const Seam& seam) {
    Json json{{"count", nodes.index.size()},
              {"max_chord_error_mm", nodes.max_chord_error_mm},
              {"index", nodes.index},
              {"positions_mm", positions_json(node_positions(seam, nodes))}};
    if (nodes.line) {
        json["max_spline_error_mm"] = nodes.line->max_error_mm;
        json["stations_mm"] = nodes.line->station_mm;
    }
    return json;
}

Json deviation_json(const Deviation& deviation) {
    return {{"signed_mean_mm", deviation.signed_mean_mm},
            {"rms_mm", deviation.rms_mm},
            {"p50_mm", deviation.p50_mm},
            {"p95_mm", deviation.p95_mm},
            {"p997_mm", deviation.p997_mm},
            {"max_mm", deviation.max_mm},
            {"coverage", deviation.coverage},
            {"tolerance_mm", deviation.tolerance_mm},
            {"pass", deviation.pass},
            {"verdict", deviation.verdict}};
}

}  // namespace

std::string seam_points_csv(const std::vector<Seam>& seams) {
    std::string text = "seam,index,station_mm,x,y,z,n1x,n1y,n1z,n2x,n2y,n2z,sigma_mm\n";
    for (std::size_t s = 0; s < seams.size(); ++s) {
        const auto& points = seams[s].points;
        double station_mm = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto& [p, n1, n2, sigma_mm, modelled] = points[i];
            station_mm += i > 0 ? (p - points[i - 1].p).norm() : 0;
            std::string line = std::to_string(s) + "," + std::to_string(i);
            append(line, {station_mm, p.x(), p.y(), p.z(), n1.x(), n1.y(), n1.z(), n2.x(), n2.y(), n2.z(), sigma_mm});
            text += line + "\n";
        }
    }
    return text;
}

std::string groove_csv(const std::vector<Seam>& seams) {
    std::string header = "seam,index,station_mm", text;
    for (const GrooveColumn& column : kGrooveColumns) {
        for (const std::string_view what : {"_", "_sigma_"}) {
            header.append(",").append(column.name).append(what).append(column.unit);
        }
    }
    for (std::size_t s = 0; s < seams.size(); ++s) {
        std::vector<std::vector<Measured>> columns;
        for (const GrooveColumn& column : kGrooveColumns) {
            columns.push_back(groove_values(seams[s], column));
        }
        double station_mm = 0;
        for (std::size_t i = 0; i < seams[s].groove.size(); ++i) {
            station_mm += i > 0 ? (seams[s].points[i].p - seams[s].points[i - 1].p).norm() : 0;
            text += std::to_string(s) + "," + std::to_string(i) + "," + shortest(station_mm);
            for (const auto& column : columns) {
                for (const double value : {column[i].value, column[i].sigma}) {
                    text += "," + (std::isfinite(value) ? shortest(value) : "");
                }
            }
            text += "\n";
        }
    }
    return text.empty() ? "" : header + "\n" + text;
}

std::string frame_of(const PartResult& part) {
    return part.nominal ? "nominal" : "scan";
}

std::string waypoints_csv(const std::vector<Waypoint>& waypoints, const std::string& frame) {
    std::string text = "# frame: " + frame +
                       " (right-handed); tool frame: +Z along the torch into the joint, +X along travel\n" +
                       "# unit: mm, s, mm/s\n" + "# quaternion: qw,qx,qy,qz, " + frame + "_from_tool\n" +
                       "seam,index,kind,station_mm,x,y,z,qw,qx,qy,qz,speed_mm_s,time_s,sigma_mm\n";
    for (const auto& w : waypoints) {
        std::string line = std::to_string(w.seam) + "," + std::to_string(w.index) + "," + std::string(name(w.kind));
        append(line, {w.station_mm, w.p.x(), w.p.y(), w.p.z(), w.q.w(), w.q.x(), w.q.y(), w.q.z(), w.speed_mm_s,
                      w.time_s, w.sigma_mm});
        text += line + "\n";
    }
    return text;
}

std::string passes_csv(const std::vector<PlannedPass>& passes) {
    std::string text =
        "# from the seam to the wire's aim, in the section square to travel, means along the seam: across towards "
        "flank "
        "1, up along the groove's middle; tilt of the torch's body towards flank 1\n"
        "# unit: mm, mm2, deg\n"
        "seam,pass,layer,bead,across_mm,up_mm,tilt_deg,area_mm2,least_area_mm2,most_area_mm2\n";
    int pass = 0;
    for (std::size_t i = 0; i < passes.size(); ++i) {
        const auto& [seam, layer, bead, across_mm, up_mm, tilt_rad, area_mm2, least_mm2, most_mm2] = passes[i];
        pass = i > 0 && passes[i - 1].seam == seam ? pass + 1 : 0;
        std::string line = std::to_string(seam) + "," + std::to_string(pass) + "," + std::to_string(layer) + "," +
                           std::to_string(bead);
        append(line, {across_mm, up_mm, tilt_rad * 180 / std::numbers::pi, area_mm2, least_mm2, most_mm2});
        text += line + "\n";
    }
    return text;
}

std::string joints_csv(const ArmTravel& arm) {
    std::string text =
        "# arm: " + arm.arm +
        "\n# unit: mm, s, deg; roll: of the torch about its wire; waypoint: row of waypoints.csv, from 0\n"
        "# time: welds as planned, ways through the air as the axes make them\n"
        "seam,kind,waypoint,station_mm,time_s,j1_deg,j2_deg,j3_deg,j4_deg,j5_deg,j6_deg,roll_deg,"
        "manipulability_m3\n";
    for (const ArmSample& s : arm.samples) {
        std::string line = std::to_string(s.seam) + "," + std::string(name(s.kind)) + "," +
                           (s.waypoint >= 0 ? std::to_string(s.waypoint) : "");
        append(line, {s.station_mm, s.time_s});
        for (const double q : s.q) {
            append(line, {q * kDegreesPerRadian});
        }
        append(line, {s.roll * kDegreesPerRadian, s.manipulability});
        text += line + "\n";
    }
    return text;
}

std::string seams_json(const PartResult& part) {
    Json seams = Json::array();
    for (std::size_t i = 0; i < part.models.size(); ++i) {
        const SeamModel& model = part.models[i];
        Json seam{{"seam", i}, {"kind", name(model.kind)}, {"closed", model.closed}, {"length_mm", model.length_mm}};
        if (part.nominal) {
            seam["model"] = model_json(model);
        } else {
            const Seam& extracted = part.extraction.seams.at(i);
            seam["confidence"] = extracted.confidence;
            seam["kind_reason"] = valid_utf8(extracted.kind_reason);
            seam["points"] = extracted.points.size();
            seam["model"] = model_json(model);
            seam["nodes"] = nodes_json(part.nodes.at(i), extracted);
            seam["deviation"] = deviation_json(part.deviations.at(i));
        }
        seams.push_back(std::move(seam));
    }
    return Json{{"frame", frame_of(part)}, {"unit", "mm"}, {"seams", std::move(seams)}}.dump(1) + "\n";
}

std::string manifest_json(const std::vector<ProgramFile>& programs, const std::string& robot) {
    Json files = Json::array();
    for (const auto& program : programs) {
        if (program.robot == robot) {
            files.push_back({{"file", program.file_name},
                             {"sha256", sha256(program.content)},
                             {"bytes", program.content.size()},
                             {"position_rounding_mm", program.position_rounding_mm},
                             {"max_position_error_mm", program.max_position_error_mm},
                             {"max_orientation_error_deg", program.max_orientation_error_deg},
                             {"max_speed_error", program.max_speed_error},
                             {"max_axis_error_deg", program.max_axis_error_deg},
                             {"max_path_error_mm", program.max_path_error_mm},
                             {"max_path_turn_deg", program.max_path_turn_deg},
                             {"moves", program.moves}});
        }
    }
    return Json{{"robot", robot}, {"files", std::move(files)}}.dump(4) + "\n";
}

}  // namespace seampath
