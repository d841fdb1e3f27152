#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/table.hpp"

/// The papers' tables, which lie beside this file.
namespace seampath {

inline std::filesystem::path paper_file(const std::string& name) {
    return std::filesystem::path(SEAMPATH_SOURCE_DIR) / "tests" / "papers" / name;
}

inline std::vector<double> paper_column(const std::string& name, std::size_t column) {
    std::vector<double> values;
    for (const auto& row : read_table(paper_file(name)).rows) {
        values.push_back(row.at(column));
    }
    return values;
}

inline std::vector<Eigen::VectorXd> paper_points(const std::string& name) {
    std::vector<Eigen::VectorXd> points;
    for (const auto& row : read_table(paper_file(name)).rows) {
        points.emplace_back(Eigen::Map<const Eigen::VectorXd>(row.data(), static_cast<Eigen::Index>(row.size())));
    }
    return points;
}

/// Points as rows.
inline Eigen::MatrixXd as_matrix(const std::vector<Eigen::VectorXd>& points) {
    Eigen::MatrixXd z(static_cast<Eigen::Index>(points.size()), points[0].size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        z.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
    }
    return z;
}

/// h_i = t_i - t_{i-1}.
inline Eigen::VectorXd spacing(const std::vector<double>& t) {
    Eigen::VectorXd h(static_cast<Eigen::Index>(t.size()) - 1);
    for (Eigen::Index i = 0; i < h.size(); ++i) {
        h[i] = t[static_cast<std::size_t>(i) + 1] - t[static_cast<std::size_t>(i)];
    }
    return h;
}

/// Ordinates as points of one dimension.
inline std::vector<Eigen::VectorXd> as_points(const std::vector<double>& values) {
    std::vector<Eigen::VectorXd> points;
    points.reserve(values.size());
    for (const double value : values) {
        points.emplace_back(Eigen::VectorXd::Constant(1, value));
    }
    return points;
}

}  // namespace seampath
