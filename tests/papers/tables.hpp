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
