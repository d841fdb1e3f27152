#include "stages/read/mesh.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "stages/read/columns.hpp"

namespace seampath {
namespace {

constexpr double kSampleLimit = 2e7;
constexpr std::size_t kBlockSamples = 1 << 16;

bool is_usable(const Eigen::Vector3d& p) {
    return (p.array().abs() <= kCoordinateLimit).all();
}

std::array<Eigen::Vector3d, 3> corners(const Mesh& mesh, std::size_t face) {
    const auto& f = mesh.faces[face];
    return {mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]};
}

/// Twice the area, along the normal; 0 for a face that cannot be used.
Eigen::Vector3d area_vector(const std::array<Eigen::Vector3d, 3>& c) {
    if (!std::all_of(c.begin(), c.end(), is_usable)) {
        return Eigen::Vector3d::Zero();
    }
    return (c[1] - c[0]).cross(c[2] - c[0]);
}

/// Number of the first sample on each face, and of all samples.
std::vector<std::size_t> share_samples(const Source& source, const Mesh& mesh, double spacing) {
    std::vector<std::size_t> first{0};
    first.reserve(mesh.faces.size() + 1);
    double due = 0.5;
    for (std::size_t face = 0; face < mesh.faces.size(); ++face) {
        due += area_vector(corners(mesh, face)).norm() / 2 / (spacing * spacing);
        if (!(due <= kSampleLimit)) {
            fail(source,
                 "its faces would give more than " + std::to_string(static_cast<long>(kSampleLimit)) +
                     " points at read.mesh_spacing_mm; expected fewer; raise read.mesh_spacing_mm or check read.unit");
        }
        first.push_back(static_cast<std::size_t>(due));
    }
    return first;
}

double fraction(double x) {
    return x - static_cast<double>(static_cast<std::int64_t>(x));
}

/// Element n of R2, folded from the unit square into the triangle below its diagonal.
Eigen::Vector2d triangle_point(std::size_t n) {
    constexpr double kPlastic = 1.32471795724474602596;  // the real root of x^3 = x + 1
    const double u = fraction(0.5 + static_cast<double>(n) / kPlastic);
    const double v = fraction(0.5 + static_cast<double>(n) / (kPlastic * kPlastic));
    return u + v <= 1 ? Eigen::Vector2d(u, v) : Eigen::Vector2d(1 - u, 1 - v);
}

/// Adds samples begin .. end - 1, whose faces are found in `first`.
void add_samples(const Mesh& mesh, const std::vector<std::size_t>& first, std::size_t begin, std::size_t end,
                 Slots& slots) {
    auto face = static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), begin) - first.begin()) - 1;
    for (std::size_t n = begin; n < end; ++face) {
        const auto c = corners(mesh, face);
        const Eigen::Vector3d along = c[1] - c[0];
        const Eigen::Vector3d across = c[2] - c[0];
        const Eigen::Vector3d normal = along.cross(across).normalized();
        for (; n < std::min(end, first[face + 1]); ++n) {
            const Eigen::Vector2d at = triangle_point(n);
            slots.add(c[0] + at.x() * along + at.y() * across, normal, n);
        }
    }
}

Cloud vertices_as_points(const Mesh& mesh) {
    Cloud cloud;
    cloud.format = mesh.format + " (vertices)";
    if (mesh.vertices.empty()) {
        return cloud;
    }
    const auto columns = [](const std::vector<Eigen::Vector3d>& values) {
        const char* first = reinterpret_cast<const char*>(values.data());
        constexpr std::size_t kNext = sizeof(double);
        const auto axis = [&](std::size_t i) { return Column{first + i * kNext, 3 * kNext, Scalar::f64, false}; };
        return std::array<Column, 3>{axis(0), axis(1), axis(2)};
    };
    std::optional<std::array<Column, 3>> normal;
    if (mesh.normals.size() == mesh.vertices.size()) {
        normal = columns(mesh.normals);
    }
    decode_columns(cloud, columns(mesh.vertices), normal, mesh.vertices.size(), false);
    return cloud;
}

}  // namespace

Eigen::Vector3d take_vector(const Source& source, std::size_t at, std::string_view line, const std::string& needed) {
    Eigen::Vector3d p;
    for (double& value : p) {
        const std::string_view token = next_token(line);
        const auto number = parse_number(token);
        if (!number) {
            fail_at_line(source, at, in_quotes(token) + " is not a number; " + needed);
        }
        value = *number;
    }
    return p;
}

double largest_extent(const Mesh& mesh) {
    constexpr double kNone = 2 * kCoordinateLimit;
    Eigen::Vector3d low = Eigen::Vector3d::Constant(kNone);
    Eigen::Vector3d high = -low;
    for (const auto& p : mesh.vertices) {
        if (is_usable(p)) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    }
    return std::max(0.0, (high - low).maxCoeff());
}

double area(const Mesh& mesh) {
    double twice = 0;
    for (std::size_t face = 0; face < mesh.faces.size(); ++face) {
        twice += area_vector(corners(mesh, face)).norm();
    }
    return twice / 2;
}

Cloud sample_mesh(const Source& source, const Mesh& mesh, double spacing) {
    if (mesh.faces.empty()) {
        return vertices_as_points(mesh);
    }
    const auto first = share_samples(source, mesh, spacing);
    if (first.back() == 0) {
        fail(source, "its " + std::to_string(mesh.faces.size()) +
                         " faces have too little area for one point at read.mesh_spacing_mm; expected a surface; lower "
                         "read.mesh_spacing_mm or check read.unit");
    }
    Cloud cloud;
    cloud.format = mesh.format;
    std::vector<Eigen::Vector3d> samples;
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 1 + mesh.vertices.size() / 1024) {
        samples.push_back(mesh.vertices[i]);
    }
    cloud.origin = choose_origin(samples);
    std::vector<std::size_t> block_first;
    for (std::size_t n = 0; n < first.back(); n += kBlockSamples) {
        block_first.push_back(n);
    }
    block_first.push_back(first.back());
    fill_cloud(cloud, block_first, {true, false}, [&](std::size_t block, Slots& slots) {
        add_samples(mesh, first, block_first[block], block_first[block + 1], slots);
    });
    const auto is_dropped = [&](const auto& f) {
        return std::any_of(f.begin(), f.end(), [&](std::uint32_t v) { return !is_usable(mesh.vertices[v]); });
    };
    cloud.records = mesh.faces.size();
    cloud.dropped = static_cast<std::uint64_t>(std::count_if(mesh.faces.begin(), mesh.faces.end(), is_dropped));
    return cloud;
}

}  // namespace seampath
