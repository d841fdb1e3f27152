#include "tools/mechanism_path.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <string_view>

#include "pipeline/config.hpp"
#include "pipeline/pose_option.hpp"
#include "pipeline/stored_run.hpp"
#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/text.hpp"
#include "tools/table.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

void add_point(MechanismPath& path, const Vector3d& p) {
    path.points.emplace_back(p.head<2>());
    auto& height = path.height_mm;
    height =
        height ? std::array{std::min((*height)[0], p.z()), std::max((*height)[1], p.z())} : std::array{p.z(), p.z()};
}

/// Points between which straight lines are within the tolerance: one is off by |c''| h^2 / 8 at most, and c'' is linear
/// between two knots. The last point of the curve is left out.
void add_span(MechanismPath& path, const CubicBSpline& curve, double from, double to, double tolerance_mm,
              const Eigen::Isometry3d& base_from_scan) {
    const Vector3d first = second_derivative(curve, from), middle = second_derivative(curve, 0.5 * (from + to));
    const double bend = std::max(first.norm(), (2 * middle - first).norm());
    const double pieces = std::max(1.0, std::ceil((to - from) * std::sqrt(bend / (8 * tolerance_mm))));
    for (double k = 0; k < pieces; ++k) {
        add_point(path, base_from_scan * position(curve, from + (to - from) * k / pieces));
    }
}

MechanismPath path_of(const SeamModel& model, const Config& config) {
    const Eigen::Isometry3d base_from_scan = pose_of(config.export_.base_from_scan);
    const CubicBSpline& curve = model.curve;
    const double first = first_parameter(curve), last = last_parameter(curve);
    MechanismPath path;
    double from = first;
    for (const double knot : curve.knots) {
        if (knot > from && knot <= last) {
            add_span(path, curve, from, knot, config.plan.chord_tolerance_mm, base_from_scan);
            from = knot;
        }
    }
    add_point(path, base_from_scan * position(curve, curve.periodic ? first : last));
    return path;
}

MechanismPath path_of_run(const fs::path& folder, std::optional<int> seam) {
    const std::vector<SeamModel> models = load_models(folder);
    const std::string has = folder.string() + " has " + std::to_string(models.size()) + " seams";
    if (!seam && models.size() != 1) {
        throw InputError("--path: " + has + "; the path is one of them; say which with --seam, counted from 0");
    }
    const int k = seam.value_or(0);
    if (k < 0 || static_cast<std::size_t>(k) >= models.size()) {
        throw InputError("--seam: " + std::to_string(k) + "; " + has + ", counted from 0");
    }
    return path_of(models[static_cast<std::size_t>(k)], read_config(folder / "config.resolved.json"));
}

std::optional<std::size_t> column(const Table& table, std::string_view name) {
    for (std::size_t k = 0; k < table.header.size(); ++k) {
        if (table.header[k] == name || table.header[k] == std::string(name) + "_mm") {
            return k;
        }
    }
    return std::nullopt;
}

/// Which rows count: those of the seam that is asked for, or all of a table that has but one.
std::vector<const std::vector<double>*> rows_of(const Table& table, const fs::path& file, std::optional<int> seam) {
    const auto which = column(table, "seam");
    if (seam && !which) {
        throw InputError("--seam: " + file.string() + " has no column \"seam\"; leave it out");
    }
    std::vector<const std::vector<double>*> rows;
    std::set<double> seams;
    for (const auto& row : table.rows) {
        if (!seam || row[*which] == *seam) {
            rows.push_back(&row);
        }
        if (which) {
            seams.insert(row[*which]);
        }
    }
    if (!seam && seams.size() > 1) {
        throw InputError("--path: " + file.string() + " has " + std::to_string(seams.size()) +
                         " seams; the path is one of them; say which with --seam");
    }
    if (rows.empty()) {
        throw InputError("--seam: " + file.string() + " has no seam " + std::to_string(*seam) + "; its seams are " +
                         shortest(*seams.begin()) + " to " + shortest(*seams.rbegin()));
    }
    return rows;
}

MechanismPath path_of_table(const fs::path& file, std::optional<int> seam) {
    const Table table = read_table(file);
    const std::size_t x = column(table, "x").value_or(0), y = column(table, "y").value_or(1);
    if (table.rows.front().size() < 2 || x == y) {
        throw InputError(file.string() + ": there are no two columns for x and y; a row X,Y in mm a point is needed");
    }
    const auto z = column(table, "z");
    MechanismPath path;
    for (const auto* row : rows_of(table, file, seam)) {
        add_point(path, {(*row)[x], (*row)[y], z ? (*row)[*z] : 0});
    }
    path.height_mm = z ? path.height_mm : std::nullopt;
    return path;
}

}  // namespace

MechanismPath mechanism_path(const fs::path& file, std::optional<int> seam) {
    return fs::is_directory(file) ? path_of_run(file, seam) : path_of_table(file, seam);
}

}  // namespace seampath
