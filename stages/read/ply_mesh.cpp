#include <algorithm>
#include <string>

#include "stages/read/columns.hpp"
#include "stages/read/formats.hpp"
#include "stages/read/ply_header.hpp"
#include "stages/read/rows.hpp"

namespace seampath {
namespace {

/// The numbers behind the header, one after the other. read_ply() has shown that those of a binary file are there.
class PlyNumbers {
public:
    PlyNumbers(const Source& source, const ply::Header& header)
        : source_(source),
          offset_(header.data),
          ascii_(header.encoding == "ascii"),
          swap_(header.encoding == "binary_big_endian") {}

    std::size_t at() const { return offset_; }

    double next(Scalar type) {
        if (!ascii_) {
            offset_ += size_of(type);
            return load(source_.bytes.data() + offset_ - size_of(type), type, swap_);
        }
        if (line_.empty()) {
            line_ = next_row(source_.bytes, offset_);
        }
        const std::string_view token = next_token(line_);
        line_ = trimmed(line_);
        const auto number = parse_number(token);
        if (!number) {
            fail_at_line(source_, offset_ - 1, in_quotes(token) + " is not a number" + std::string(kExportAgain));
        }
        return *number;
    }

private:
    const Source& source_;
    std::size_t offset_;
    bool ascii_, swap_;
    std::string_view line_;
};

bool is_corner_list(const ply::Property& property) {
    return property.length && (property.name == "vertex_indices" || property.name == "vertex_index");
}

// A polygon becomes a fan of triangles.
void take_polygon(const Source& source, PlyNumbers& numbers, const ply::Property& property, Mesh& mesh) {
    const double corners = numbers.next(*property.length);
    std::array<std::uint32_t, 3> face{};
    for (std::size_t k = 0; static_cast<double>(k) < corners; ++k) {
        const double index = numbers.next(property.type);
        if (!(index >= 0 && index < static_cast<double>(mesh.vertices.size()))) {
            fail_at_byte(source, numbers.at(),
                         "vertex index " + std::to_string(static_cast<long long>(index)) + " in a file of " +
                             std::to_string(mesh.vertices.size()) + " vertices" + std::string(kExportAgain));
        }
        face[1] = k >= 3 ? face[2] : face[1];
        face[std::min<std::size_t>(k, 2)] = static_cast<std::uint32_t>(index);
        if (k >= 2) {
            mesh.faces.push_back(face);
        }
    }
}

}  // namespace

Mesh read_ply_mesh(const Source& source) {
    const ply::Header header = ply::read_header(source);
    const Cloud cloud = read_ply(source);
    Mesh mesh;
    mesh.format = cloud.format;
    const bool faces = std::any_of(header.elements.begin(), header.elements.end(), [](const ply::Element& element) {
        return std::any_of(element.properties.begin(), element.properties.end(), is_corner_list);
    });
    if (!faces) {
        return mesh;
    }
    if (cloud.dropped > 0) {
        fail(source, std::to_string(cloud.dropped) + " vertices of its faces are not finite; export the mesh again");
    }
    for (const auto& p : cloud.points) {
        mesh.vertices.push_back(cloud.origin + p.cast<double>());
    }
    PlyNumbers numbers(source, header);
    for (const ply::Element& element : header.elements) {
        for (std::uint64_t record = 0; record < element.count; ++record) {
            for (const ply::Property& property : element.properties) {
                if (is_corner_list(property)) {
                    take_polygon(source, numbers, property, mesh);
                } else if (property.length) {
                    for (double left = numbers.next(*property.length); left > 0; --left) {
                        numbers.next(property.type);
                    }
                } else {
                    numbers.next(property.type);
                }
            }
        }
    }
    return mesh;
}

}  // namespace seampath
