#include "stages/read/read.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "stages/error.hpp"
#include "stages/read/file.hpp"
#include "stages/read/formats.hpp"
#include "stages/read/rows.hpp"
#include "stages/read/source.hpp"
#include "stages/read/unit.hpp"

namespace seampath {
namespace {

constexpr std::size_t kBlockPoints = 1 << 16;

/// Calls `work(begin, end)` for runs of 0 .. count - 1, in parallel.
template <class Work>
void for_each_run(std::size_t count, Work work) {
    for_each_block((count + kBlockPoints - 1) / kBlockPoints,
                   [&](std::size_t block) { work(block * kBlockPoints, std::min(count, (block + 1) * kBlockPoints)); });
}

void scale(std::vector<Eigen::Vector3f>& points, double factor) {
    if (factor == 1) {
        return;
    }
    for_each_run(points.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            points[i] = (points[i].cast<double>() * factor).cast<float>();
        }
    });
}

/// Makes all normals unit; leaves none when one of them has no direction, because a scan has one for each point or
/// none.
void make_unit(std::vector<Eigen::Vector3f>& normals) {
    std::atomic<bool> usable = true;
    for_each_run(normals.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Vector3d normal = normals[i].cast<double>();
            const double length = normal.norm();
            if (!(length > 0 && length <= kCoordinateLimit)) {
                usable = false;
                return;
            }
            normals[i] = (normal / length).cast<float>();
        }
    });
    if (!usable) {
        normals = {};
    }
}

void check_not_empty(const Source& source, const Cloud& cloud) {
    if (cloud.records == 0) {
        fail(source, "holds no points; expected at least one; export the scan again");
    }
    if (cloud.points.empty()) {
        fail(source, "all " + std::to_string(cloud.records) +
                         " points are NaN, infinite or beyond 1e12; expected finite x, y and z; check the export");
    }
}

Scan finish(const std::string& name, const UnitChoice& unit, Cloud cloud) {
    Scan scan;
    scan.name = name;
    scan.format = cloud.format;
    scan.mm_per_unit = unit.mm_per_unit;
    scan.unit_reason = unit.reason;
    scan.points_in_file = cloud.records;
    scan.dropped_not_finite = cloud.dropped;
    scan.origin_mm = cloud.origin * unit.mm_per_unit;
    scan.width = cloud.width;
    scan.height = cloud.height;
    scan.pixel = std::move(cloud.record);
    if (cloud.sensor) {
        scan.sensor_mm = *cloud.sensor * unit.mm_per_unit;
    }
    scan.points = std::move(cloud.points);
    scan.normals = std::move(cloud.normals);
    scale(scan.points, unit.mm_per_unit);
    make_unit(scan.normals);
    return scan;
}

Cloud read_cloud(const Source& source, ScanFormat format) {
    switch (format) {
        case ScanFormat::ply:
            return read_ply(source);
        case ScanFormat::pcd:
            return read_pcd(source);
        default:
            return read_text(source);
    }
}

Scan read_points(const Source& source, const std::string& name, ScanFormat format, const ReadOptions& options) {
    Cloud cloud = read_cloud(source, format);
    check_not_empty(source, cloud);
    const UnitChoice unit = choose_unit(source, options.unit, format, largest_extent(cloud.points));
    return finish(name, unit, std::move(cloud));
}

Mesh mesh_of(const Source& source, ScanFormat format) {
    return format == ScanFormat::stl   ? read_stl(source)
           : format == ScanFormat::obj ? read_obj(source)
                                       : read_ply_mesh(source);
}

Scan read_mesh(const Source& source, const std::string& name, ScanFormat format, const ReadOptions& options) {
    const Mesh mesh = mesh_of(source, format);
    const UnitChoice unit = choose_unit(source, options.unit, format, largest_extent(mesh));
    Cloud cloud = sample_mesh(source, mesh, options.mesh_spacing_mm / unit.mm_per_unit);
    check_not_empty(source, cloud);
    return finish(name, unit, std::move(cloud));
}

Scan read_source(const Source& source, const std::string& name, ScanFormat format, const ReadOptions& options) {
    const bool mesh = format == ScanFormat::stl || format == ScanFormat::obj;
    return mesh ? read_mesh(source, name, format, options) : read_points(source, name, format, options);
}

/// The format of a file whose extension says nothing, from its first bytes.
std::optional<ScanFormat> format_by_content(std::string_view bytes) {
    std::size_t next = 0;
    const std::string_view row = next_row(bytes.substr(0, 4096), next);
    if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) {
        return ScanFormat::ply;
    }
    if (bytes.starts_with("# .PCD") || row.starts_with("VERSION") || row.starts_with("FIELDS")) {
        return ScanFormat::pcd;
    }
    if (is_stl(bytes)) {
        return ScanFormat::stl;
    }
    if (row.find('\0') != std::string_view::npos) {
        return std::nullopt;
    }
    for (const std::string_view word : {"v ", "vn ", "o ", "g ", "mtllib "}) {
        if (row.starts_with(word)) {
            return ScanFormat::obj;
        }
    }
    const bool numbers = !row.empty() && std::string_view("+-.0123456789").find(row.front()) != std::string_view::npos;
    return numbers ? std::optional(ScanFormat::text) : std::nullopt;
}

std::string lower_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return extension;
}

ScanFormat format_of(const std::filesystem::path& file, const Source& source) {
    constexpr std::array<std::pair<std::string_view, ScanFormat>, 8> kExtensions{{{".ply", ScanFormat::ply},
                                                                                  {".pcd", ScanFormat::pcd},
                                                                                  {".xyz", ScanFormat::text},
                                                                                  {".csv", ScanFormat::text},
                                                                                  {".asc", ScanFormat::text},
                                                                                  {".txt", ScanFormat::text},
                                                                                  {".stl", ScanFormat::stl},
                                                                                  {".obj", ScanFormat::obj}}};
    const std::string extension = lower_extension(file);
    for (const auto& [known, format] : kExtensions) {
        if (extension == known) {
            return format;
        }
    }
    if (const auto format = format_by_content(source.bytes)) {
        return *format;
    }
    fail(source,
         "extension " + in_quotes(extension) +
             " is not known and the content tells no format; expected one of .ply .pcd .xyz .csv .asc .txt .stl .obj; "
             "rename or convert the file");
}

}  // namespace

Fields describe(ReadOptions& options) {
    return {{"unit", choice(options.unit, kUnitNames),
             "unit of the file's numbers; auto: extent of 20 or more is mm, below 2 m, in between m for PCD only"},
            {"mesh_spacing_mm", &options.mesh_spacing_mm, "distance of the points that a mesh (STL, OBJ) is sampled at",
             above(0)}};
}

Scan read(const std::filesystem::path& file, const ReadOptions& options) {
    const FileBytes bytes(file);
    const Source source{bytes.view(), file.string()};
    return read_source(source, file.stem().string(), format_of(file, source), options);
}

Scan read_surface(const std::filesystem::path& file, Unit unit, std::size_t count) {
    const FileBytes bytes(file);
    const Source source{bytes.view(), file.string()};
    const ScanFormat format = format_of(file, source);
    const std::string name = file.stem().string();
    if (format == ScanFormat::pcd || format == ScanFormat::text) {
        return read_points(source, name, format, {unit});
    }
    const Mesh mesh = mesh_of(source, format);
    if (mesh.faces.empty()) {
        return read_source(source, name, format, {unit});
    }
    const UnitChoice chosen = choose_unit(source, unit, format, largest_extent(mesh));
    const double spacing = std::sqrt(area(mesh) / static_cast<double>(count));
    Cloud cloud = sample_mesh(source, mesh, spacing > 0 ? spacing : 1);
    check_not_empty(source, cloud);
    return finish(name, chosen, std::move(cloud));
}

Scan read_bytes(std::span<const std::byte> bytes, ScanFormat format, const std::string& name,
                const ReadOptions& options) {
    const Source source{{reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name};
    if (bytes.empty()) {
        fail(source, "is empty (0 bytes); expected a scan; export or copy the file again");
    }
    return read_source(source, name, format, options);
}

}  // namespace seampath
