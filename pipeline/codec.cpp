#include "pipeline/codec.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "pipeline/json_text.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

template <class T, class U>
concept Is = std::is_same_v<std::remove_const_t<T>, U>;

// One list of members a struct, for writing and reading. The structured bindings make a member that is added to the
// struct and forgotten here an error of compilation.

void members(auto& archive, Is<SeamPoint> auto& v) {
    auto& [p, n1, n2, sigma_mm, modelled] = v;
    archive("p", p)("n1", n1)("n2", n2)("sigma_mm", sigma_mm)("modelled", modelled);
}

void members(auto& archive, Is<Measured> auto& v) {
    auto& [value, sigma] = v;
    archive("value", value)("sigma", sigma);
}

void members(auto& archive, Is<GrooveStation> auto& v) {
    auto& [gap_mm, mismatch_mm, bevel1_rad, bevel2_rad, included_angle_rad, depth_mm, root_face_mm, area_mm2] = v;
    archive("gap_mm", gap_mm)("mismatch_mm", mismatch_mm)("bevel1_rad", bevel1_rad)("bevel2_rad", bevel2_rad);
    archive("included_angle_rad", included_angle_rad)("depth_mm", depth_mm)("root_face_mm", root_face_mm);
    archive("area_mm2", area_mm2);
}

void members(auto& archive, Is<FlankSurface> auto& v) {
    auto& [shape, point, direction, size, bore, explains, scale, taken, origin, e0, e1, lever, covariance] = v;
    archive("shape", shape)("point_mm", point)("direction", direction)("size", size)("bore", bore);
    archive("explains", explains)("scale_mm", scale)("share_taken", taken);
    archive("origin_mm", origin)("e0", e0)("e1", e1)("lever_mm", lever)("covariance_mm2", covariance);
}

void members(auto& archive, Is<SeamSurfaces> auto& v) {
    auto& [first, second, covariance_between] = v;
    archive("first", first)("second", second)("covariance_between_mm2", covariance_between);
}

void members(auto& archive, Is<Seam> auto& v) {
    auto& [kind, closed, confidence, kind_reason, points, groove, surfaces, corners] = v;
    archive("kind", kind)("closed", closed)("confidence", confidence)("kind_reason", kind_reason)("points", points);
    archive("groove", groove)("surfaces", surfaces)("corners", corners);
}

void members(auto& archive, Is<Extraction> auto& v) {
    auto& [seams, spacing_mm, noise_mm, views, registration_mm, orientation_reason, remarks] = v;
    archive("seams", seams)("spacing_mm", spacing_mm)("noise_mm", noise_mm);
    archive("views", views)("registration_mm", registration_mm);
    archive("orientation_reason", orientation_reason)("remarks", remarks);
}

void members(auto& archive, Is<NodeLine> auto& v) {
    auto& [station_mm, p, length_mm, max_error_mm] = v;
    archive("station_mm", station_mm)("p", p)("length_mm", length_mm)("max_error_mm", max_error_mm);
}

void members(auto& archive, Is<Nodes> auto& v) {
    auto& [index, max_chord_error_mm, line] = v;
    archive("index", index)("max_chord_error_mm", max_chord_error_mm)("line", line);
}

void members(auto& archive, Is<CubicBSpline> auto& v) {
    auto& [periodic, knots, control] = v;
    archive("periodic", periodic)("knots_mm", knots)("control_mm", control);
}

void members(auto& archive, Is<FlankSample> auto& v) {
    auto& [station_mm, n1, n2, sigma_mm, modelled] = v;
    archive("station_mm", station_mm)("n1", n1)("n2", n2)("sigma_mm", sigma_mm)("modelled", modelled);
}

void members(auto& archive, Is<SaddleParameters> auto& v) {
    auto& [header, branch_radius_mm, header_radius_mm, angle_rad, offset_mm] = v;
    archive("header", header)("branch_radius_mm", branch_radius_mm)("header_radius_mm", header_radius_mm);
    archive("angle_rad", angle_rad)("offset_mm", offset_mm);
}

void members(auto& archive, Is<BandSample> auto& v) {
    auto& [station_mm, half_width_mm] = v;
    archive("station_mm", station_mm)("half_width_mm", half_width_mm);
}

void members(auto& archive, Is<SeamModel> auto& v) {
    auto& [kind, closed, curve, length_mm, flanks, rms_mm, max_mm, degrees_of_freedom, model, reason, saddle, band,
           corners_mm] = v;
    archive("kind", kind)("closed", closed)("curve", curve)("length_mm", length_mm)("flanks", flanks);
    archive("residual_rms_mm", rms_mm)("residual_max_mm", max_mm)("degrees_of_freedom", degrees_of_freedom);
    archive("model", model)("reason", reason)("saddle", saddle)("band", band);
    archive("corners_mm", corners_mm);
}

void members(auto& archive, Is<DeviationSample> auto& v) {
    auto& [station_mm, p, flank1_mm, flank2_mm, distance_mm, sigma_mm, covered] = v;
    archive("station_mm", station_mm)("p", p)("flank1_mm", flank1_mm)("flank2_mm", flank2_mm);
    archive("distance_mm", distance_mm)("sigma_mm", sigma_mm)("covered", covered);
}

void members(auto& archive, Is<Deviation> auto& v) {
    auto& [samples, signed_mean, rms, p50, p95, p997, max, coverage, tolerance, pass, verdict] = v;
    archive("samples", samples)("signed_mean_mm", signed_mean)("rms_mm", rms)("p50_mm", p50)("p95_mm", p95);
    archive("p997_mm", p997)("max_mm", max)("coverage", coverage)("tolerance_mm", tolerance)("pass", pass);
    archive("verdict", verdict);
}

void members(auto& archive, Is<Waypoint> auto& v) {
    auto& [seam, index, kind, station_mm, p, q, speed_mm_s, time_s, sigma_mm] = v;
    archive("seam", seam)("index", index)("kind", kind)("station_mm", station_mm)("p", p)("q", q);
    archive("speed_mm_s", speed_mm_s)("time_s", time_s)("sigma_mm", sigma_mm);
}

void members(auto& archive, Is<PlannedPass> auto& v) {
    auto& [seam, layer, bead, across_mm, up_mm, tilt_rad, area_mm2, least_mm2, most_mm2] = v;
    archive("seam", seam)("layer", layer)("bead", bead)("across_mm", across_mm)("up_mm", up_mm);
    archive("tilt_rad", tilt_rad)("area_mm2", area_mm2)("least_mm2", least_mm2)("most_mm2", most_mm2);
}

void members(auto& archive, Is<TravelSample> auto& v) {
    auto& [seam, weld, station_mm, speed, acceleration, centripetal, turn_rate, work_rad, travel_rad] = v;
    archive("seam", seam)("weld", weld)("station_mm", station_mm)("speed_mm_s", speed);
    archive("acceleration_mm_s2", acceleration)("centripetal_mm_s2", centripetal)("turn_rate_rad_s", turn_rate);
    archive("work_rad", work_rad)("travel_rad", travel_rad);
}

void members(auto& archive, Is<SeamRefusal> auto& v) {
    auto& [seam, station_mm, depth_mm, reason] = v;
    archive("seam", seam)("station_mm", station_mm)("depth_mm", depth_mm)("reason", reason);
}

void members(auto& archive, Is<ArmSample> auto& v) {
    auto& [seam, kind, waypoint, station_mm, time_s, q, roll, manipulability] = v;
    archive("seam", seam)("kind", kind)("waypoint", waypoint)("station_mm", station_mm)("time_s", time_s);
    archive("q_rad", q)("roll_rad", roll)("manipulability_m3", manipulability);
}

void members(auto& archive, Is<ArmTravel> auto& v) {
    auto& [arm, pass, verdict, lowest, highest, max_speed, max_acceleration, speed_share, acceleration_share,
           least_margin, least_manipulability, max_roll, duration_s, samples, shift_mm] = v;
    archive("arm", arm)("pass", pass)("verdict", verdict)("lowest_rad", lowest)("highest_rad", highest);
    archive("max_speed_rad_s", max_speed)("max_acceleration_rad_s2", max_acceleration);
    archive("speed_share", speed_share)("acceleration_share", acceleration_share);
    archive("least_margin_rad", least_margin)("least_manipulability_m3", least_manipulability);
    archive("max_roll_rad", max_roll)("duration_s", duration_s)("samples", samples)("shift_mm", shift_mm);
}

void members(auto& archive, Is<Plan> auto& v) {
    auto& [waypoints, max_chord_error_mm, max_speed_error, max_turn_deg, duration_s, passes, travel, refused, arm] = v;
    archive("waypoints", waypoints)("max_chord_error_mm", max_chord_error_mm)("max_speed_error", max_speed_error);
    archive("max_turn_deg", max_turn_deg)("duration_s", duration_s)("passes", passes);
    archive("travel", travel)("refused", refused)("arm", arm);
}

// The rest of the text of a scan is for people.
void members(auto& archive, Is<ScanRecord> auto& v) {
    auto& [file, file_sha256] = v;
    archive("file", file)("file_sha256", file_sha256);
}

class Writer {
public:
    template <class T>
    static Json put(const T& value) {
        if constexpr (std::is_same_v<T, double>) {
            return std::isfinite(value) ? Json(value) : Json(std::isnan(value) ? "nan" : shortest(value));
        } else if constexpr (std::is_enum_v<T>) {
            return name(value);
        } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
            return value;
        } else if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
            return {put(value.x()), put(value.y()), put(value.z())};
        } else if constexpr (std::is_same_v<T, Eigen::Quaterniond>) {
            return {put(value.w()), put(value.x()), put(value.y()), put(value.z())};
        } else {
            Writer writer;
            members(writer, value);
            return writer.take();
        }
    }

    template <class T>
    static Json put(const std::vector<T>& values) {
        Json list = Json::array();
        for (const auto& value : values) {
            list.push_back(put(value));
        }
        return list;
    }

    template <class T, std::size_t n>
    static Json put(const std::array<T, n>& values) {
        Json list = Json::array();
        for (const auto& value : values) {
            list.push_back(put(value));
        }
        return list;
    }

    template <class T>
    static Json put(const std::optional<T>& value) {
        return value ? put(*value) : Json();
    }

    template <class T>
    Writer& operator()(const char* key, const T& value) {
        object_[key] = put(value);
        return *this;
    }

    Json take() { return std::move(object_); }

private:
    Json object_ = Json::object();
};

class Reader {
public:
    explicit Reader(const Json& object) : object_(object) {}

    template <class T>
    static void get(const Json& json, T& value) {
        if constexpr (std::is_same_v<T, double>) {
            value = json.is_string() ? not_finite(json.get<std::string>()) : json.get<double>();
        } else if constexpr (std::is_same_v<T, SurfaceShape>) {
            value = static_cast<SurfaceShape>(position(json, kSurfaceShapeNames));
        } else if constexpr (std::is_same_v<T, JointKind>) {
            value = static_cast<JointKind>(position(json, kJointKindNames));
        } else if constexpr (std::is_same_v<T, WaypointKind>) {
            value = static_cast<WaypointKind>(position(json, kWaypointKindNames));
        } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
            value = json.get<T>();
        } else if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
            for (std::size_t i = 0; i < 3; ++i) {
                get(json.at(i), value[static_cast<Eigen::Index>(i)]);
            }
        } else if constexpr (std::is_same_v<T, Eigen::Quaterniond>) {
            get(json.at(0), value.w());
            get(json.at(1), value.x());
            get(json.at(2), value.y());
            get(json.at(3), value.z());
        } else {
            Reader reader(json);
            members(reader, value);
        }
    }

    template <class T>
    static void get(const Json& json, std::vector<T>& values) {
        values.resize(json.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            get(json.at(i), values[i]);
        }
    }

    template <class T, std::size_t n>
    static void get(const Json& json, std::array<T, n>& values) {
        for (std::size_t i = 0; i < n; ++i) {
            get(json.at(i), values[i]);
        }
    }

    template <class T>
    static void get(const Json& json, std::optional<T>& value) {
        value.reset();
        if (!json.is_null()) {
            get(json, value.emplace());
        }
    }

    template <class T>
    Reader& operator()(const char* key, T& value) {
        get(object_.at(key), value);
        return *this;
    }

private:
    static double not_finite(const std::string& text) {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        return text == "inf" ? kInfinity : text == "-inf" ? -kInfinity : std::numeric_limits<double>::quiet_NaN();
    }

    static std::size_t position(const Json& json, const auto& names) {
        const auto word = json.get<std::string>();
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (names[i] == word) {
                return i;
            }
        }
        throw std::runtime_error("\"" + word + "\" is no known name");
    }

    const Json& object_;
};

/// Bytes of a file name that are no UTF-8 are replaced.
std::string one_line(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

template <class T>
std::string to_text(const T& value) {
    return one_line(Writer::put(value));
}

template <class T>
void from_text(std::string_view text, T& value) {
    try {
        // On the heap: GCC 12 warns of an optional's members that could be uninitialised where they are not.
        const auto read = std::make_unique<T>();
        Reader::get(parse_json(text), *read);
        value = std::move(*read);
    } catch (const Json::exception& error) {
        throw std::runtime_error(error.what());
    }
}

}  // namespace

std::string encode(const Extraction& value) {
    return to_text(value);
}
std::string encode(const std::vector<Nodes>& value) {
    return to_text(value);
}
std::string encode(const std::vector<SeamModel>& value) {
    return to_text(value);
}
std::string encode(const std::vector<Deviation>& value) {
    return to_text(value);
}
std::string encode(const Plan& value) {
    return to_text(value);
}

std::string encode(const Scan& scan, const ScanRecord& record) {
    Writer writer;
    writer("name", scan.name);
    members(writer, record);
    writer("format", scan.format);
    writer("mm_per_unit", scan.mm_per_unit)("unit_reason", scan.unit_reason);
    writer("points", scan.points.size())("points_in_file", scan.points_in_file);
    writer("dropped_not_finite", scan.dropped_not_finite)("normals", !scan.normals.empty());
    writer("width", scan.width)("height", scan.height)("origin_mm", scan.origin_mm);
    return one_line(writer.take());
}

void decode(std::string_view text, Extraction& value) {
    from_text(text, value);
}
void decode(std::string_view text, std::vector<Nodes>& value) {
    from_text(text, value);
}
void decode(std::string_view text, std::vector<SeamModel>& value) {
    from_text(text, value);
}
void decode(std::string_view text, std::vector<Deviation>& value) {
    from_text(text, value);
}
void decode(std::string_view text, Plan& value) {
    from_text(text, value);
}
void decode(std::string_view text, ScanRecord& value) {
    from_text(text, value);
}

}  // namespace seampath
