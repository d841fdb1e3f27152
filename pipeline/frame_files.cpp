#include "pipeline/frame_files.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/geometry/rigid.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// a, b, c with R = Rz(a) Ry(b) Rx(c), rad, b within +-90 degrees; at its ends c is 0.
Vector3d zyx_angles(const Matrix3d& R) {
    const double cosine = std::hypot(R(0, 0), R(1, 0)), b = std::atan2(-R(2, 0), cosine);
    if (cosine < 1e-12) {
        return {std::atan2(-R(0, 1), R(1, 1)), b, 0};
    }
    return {std::atan2(R(1, 0), R(0, 0)), b, std::atan2(R(2, 1), R(2, 2))};
}

Isometry3d from_zyx(const Vector3d& p, double a, double b, double c) {
    Isometry3d T = Isometry3d::Identity();
    T.linear() =
        (AngleAxisd(a, Vector3d::UnitZ()) * AngleAxisd(b, Vector3d::UnitY()) * AngleAxisd(c, Vector3d::UnitX()))
            .toRotationMatrix();
    T.translation() = p;
    return T;
}

/// Numbers with so many decimals.
std::string list(std::initializer_list<double> values, int decimals, const char* between) {
    std::string text;
    for (const double value : values) {
        text += (text.empty() ? "" : between) + fixed(value, decimals);
    }
    return text;
}

std::string identifier(const std::string& name, std::size_t most) {
    std::string word;
    for (const char c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        word += plain ? c : '_';
    }
    return word.substr(0, most);
}

std::string upper(std::string word) {
    std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::toupper(c); });
    return word;
}

// ABB RAPID: mm, quaternion w x y z; names of at most 32 characters, files of at most 80 columns a string.
std::string abb(const Isometry3d& T, const std::string& name, int) {
    const Vector3d p = T.translation();
    const Quaterniond q(T.linear());
    return "MODULE " + identifier("Frame_" + name, 32) +
           "\n    ! base from part: mm, quaternion w x y z\n    PERS wobjdata " + identifier("w_" + name, 32) +
           ":=[FALSE,TRUE,\"\",[[" + list({p.x(), p.y(), p.z()}, 4, ",") + "],[" +
           list({q.w(), q.x(), q.y(), q.z()}, 9, ",") + "]],[[0,0,0],[1,0,0,0]]];\nENDMODULE\n";
}

// KUKA KRL: mm, degrees, R = Rz(A) Ry(B) Rx(C).
std::string kuka(const Isometry3d& T, const std::string& name, int number) {
    const Vector3d p = T.translation(), a = zyx_angles(T.linear()) / kDegree;
    const std::string n = std::to_string(number);
    return "; base from part: mm, deg; lines of $config.dat\nBASE_NAME[" + n + ",]=\"" + identifier(name, 24) +
           "\"\nBASE_DATA[" + n + "]={X " + fixed(p.x(), 4) + ",Y " + fixed(p.y(), 4) + ",Z " + fixed(p.z(), 4) +
           ",A " + fixed(a[0], 6) + ",B " + fixed(a[1], 6) + ",C " + fixed(a[2], 6) + "}\n";
}

// FANUC TP: mm, degrees, R = Rz(R) Ry(P) Rx(W). A negative constant stands in brackets. The program fills a position
// register and makes it the user frame.
std::string fanuc(const Isometry3d& T, const std::string& name, int number) {
    const Vector3d p = T.translation(), a = zyx_angles(T.linear()) / kDegree;
    const std::string n = std::to_string(number);
    std::vector<std::string> lines{"!X Y Z mm, W P R deg", "PR[" + n + "]=UFRAME[" + n + "]"};
    const std::array<double, 6> values{p.x(), p.y(), p.z(), a[2], a[1], a[0]};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string value = fixed(values[i], 4);
        lines.push_back("PR[" + n + "," + std::to_string(i + 1) + "]=" + (value[0] == '-' ? "(" + value + ")" : value));
    }
    lines.push_back("UFRAME[" + n + "]=PR[" + n + "]");
    std::string text = "/PROG  " + upper(identifier("UF_" + name, 32)) +
                       "\r\n/ATTR\r\nCOMMENT\t\t= \"BASE FROM PART\";\r\n"
                       "LINE_COUNT\t= " +
                       std::to_string(lines.size()) + ";\r\nDEFAULT_GROUP\t= 1,*,*,*,*;\r\n/MN\r\n";
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::string index = std::to_string(i + 1);
        text += std::string(4 - index.size(), ' ') + index + ":  " + lines[i] + " ;\r\n";
    }
    return text + "/POS\r\n/END\r\n";
}

// URScript: metres and a rotation vector.
std::string ur(const Isometry3d& T, const std::string& name, int) {
    const Vector3d p = T.translation() / 1000, w = rotation_vector(Quaterniond(T.linear()));
    return "# base from part: m, rotation vector in rad\n" + identifier("frame_" + name, 64) + " = p[" +
           list({p.x(), p.y(), p.z(), w.x(), w.y(), w.z()}, 8, ", ") + "]\n";
}

// Yaskawa UFRAME.CND: mm, degrees, R = Rz(Rz) Ry(Ry) Rx(Rx).
std::string yaskawa(const Isometry3d& T, const std::string& name, int number) {
    const Vector3d p = T.translation(), a = zyx_angles(T.linear()) / kDegree;
    return "//UFRAME " + std::to_string(number) + "\r\n///NAME " + upper(identifier(name, 16)) +
           "\r\n///TOOL 0\r\n////BUSER " + list({p.x(), p.y(), p.z()}, 3, ",") + "," +
           list({a[2], a[1], a[0]}, 4, ",") + "\r\n";
}

std::string json(const Isometry3d& T, const std::string& name, int) {
    const Vector3d p = T.translation();
    const Quaterniond q(T.linear());
    const nlohmann::ordered_json value{{"name", name},
                                       {"meaning", "base from part"},
                                       {"position_mm", {p.x(), p.y(), p.z()}},
                                       {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}}};
    return value.dump(2) + "\n";
}

// URDF: metres, roll pitch yaw in rad about fixed axes: R = Rz(yaw) Ry(pitch) Rx(roll).
std::string urdf(const Isometry3d& T, const std::string&, int) {
    const Vector3d p = T.translation() / 1000, a = zyx_angles(T.linear());
    return "<origin xyz=\"" + list({p.x(), p.y(), p.z()}, 9, " ") + "\" rpy=\"" + list({a[2], a[1], a[0]}, 9, " ") +
           "\"/>\n";
}

/// The numbers that follow a mark, up to `count`, whatever stands between them.
std::vector<double> numbers_after(const std::string& text, const std::string& mark, std::size_t count) {
    const auto at = text.find(mark);
    ensure(at != std::string::npos, "the file holds its frame");
    std::vector<double> values;
    const char* c = text.data() + at + mark.size();
    const char* const end = text.data() + text.size();
    while (c < end && values.size() < count) {
        double value = 0;
        const auto read = std::from_chars(c, end, value);
        if (read.ec == std::errc{}) {
            values.push_back(value);
            c = read.ptr;
        } else {
            ++c;
        }
    }
    ensure(values.size() == count, "the file holds all numbers of its frame");
    return values;
}

Isometry3d from_quaternion(const Vector3d& p, double w, double x, double y, double z) {
    Isometry3d T = Isometry3d::Identity();
    T.linear() = Quaterniond(w, x, y, z).normalized().toRotationMatrix();
    T.translation() = p;
    return T;
}

Isometry3d read_abb(const std::string& text) {
    const auto v = numbers_after(text, "TRUE,\"\",[[", 7);
    return from_quaternion({v[0], v[1], v[2]}, v[3], v[4], v[5], v[6]);
}

Isometry3d read_kuka(const std::string& text) {
    const auto v = numbers_after(text, "={X", 6);
    return from_zyx({v[0], v[1], v[2]}, v[3] * kDegree, v[4] * kDegree, v[5] * kDegree);
}

Isometry3d read_fanuc(const std::string& text) {
    std::array<double, 6> v{};
    const std::string n = std::to_string(static_cast<int>(numbers_after(text, "UFRAME[", 1)[0]));
    for (std::size_t i = 0; i < v.size(); ++i) {
        v[i] = numbers_after(text, "PR[" + n + "," + std::to_string(i + 1) + "]=", 1)[0];
    }
    return from_zyx({v[0], v[1], v[2]}, v[5] * kDegree, v[4] * kDegree, v[3] * kDegree);
}

Isometry3d read_ur(const std::string& text) {
    const auto v = numbers_after(text, " = p[", 6);
    Isometry3d T = Isometry3d::Identity();
    T.linear() = turn_by({v[3], v[4], v[5]}).toRotationMatrix();
    T.translation() = 1000 * Vector3d(v[0], v[1], v[2]);
    return T;
}

Isometry3d read_yaskawa(const std::string& text) {
    const auto v = numbers_after(text, "BUSER", 6);
    return from_zyx({v[0], v[1], v[2]}, v[5] * kDegree, v[4] * kDegree, v[3] * kDegree);
}

Isometry3d read_json(const std::string& text) {
    const auto value = nlohmann::json::parse(text);
    const auto p = value.at("position_mm").get<std::vector<double>>();
    const auto q = value.at("quaternion_wxyz").get<std::vector<double>>();
    return from_quaternion({p.at(0), p.at(1), p.at(2)}, q.at(0), q.at(1), q.at(2), q.at(3));
}

Isometry3d read_urdf(const std::string& text) {
    const auto p = numbers_after(text, "xyz=\"", 3), a = numbers_after(text, "rpy=\"", 3);
    return from_zyx(1000 * Vector3d(p[0], p[1], p[2]), a[2], a[1], a[0]);
}

struct Language {
    const char* extension;
    double rounding_mm;   // half a unit of the last written place
    double rounding_rad;  // the same of angles, or of a quaternion's parts twice
    std::string (*write)(const Isometry3d&, const std::string&, int);
    Isometry3d (*read)(const std::string&);
};

constexpr std::array<Language, kFrameFormats.size()> kLanguages{{
    {"mod", 0.5e-4, 1e-9, abb, read_abb},
    {"dat", 0.5e-4, 0.5e-6 * kDegree, kuka, read_kuka},
    {"ls", 0.5e-4, 0.5e-4 * kDegree, fanuc, read_fanuc},
    {"script", 0.5e-5, 0.5e-8, ur, read_ur},
    {"CND", 0.5e-3, 0.5e-4 * kDegree, yaskawa, read_yaskawa},
    {"json", 1e-9, 1e-9, json, read_json},
    {"urdf", 0.5e-6, 0.5e-9, urdf, read_urdf},
}};

const Language& language(std::string_view format) {
    const auto found = std::find(kFrameFormats.begin(), kFrameFormats.end(), format);
    ensure(found != kFrameFormats.end(), "a known format");
    return kLanguages[static_cast<std::size_t>(found - kFrameFormats.begin())];
}

}  // namespace

std::vector<FrameFile> frame_files(const Isometry3d& base_from_part, const std::string& name, int number) {
    std::vector<FrameFile> files;
    for (const std::string_view format : kFrameFormats) {
        const Language& l = language(format);
        FrameFile file{std::string(format), {}, l.write(base_from_part, name, number), 0, 0};
        file.name = format == "yaskawa" ? "UFRAME.CND" : "frame." + std::string(l.extension);
        const Vector6 off = displacement(base_from_part, l.read(file.text));
        file.position_error_mm = off.head<3>().norm();
        file.turn_error_rad = off.tail<3>().norm();
        // Each number is rounded; where the axes of the first and last angle come together, their errors add. A tenth
        // more for the arithmetic.
        ensure(off.head<3>().cwiseAbs().maxCoeff() <= 1.1 * l.rounding_mm + 1e-9 &&
                   file.turn_error_rad <= 1.1 * std::sqrt(5.0) * l.rounding_rad + 1e-9,
               "a frame reads back as it was written");
        files.push_back(std::move(file));
    }
    return files;
}

Isometry3d read_frame(std::string_view format, const std::string& text) {
    return language(format).read(text);
}

}  // namespace seampath
