#include "pipeline/json_values.hpp"

namespace seampath {

using Json = nlohmann::ordered_json;

Json vector_json(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

Json matrix_json(const Eigen::MatrixXd& m) {
    Json rows = Json::array();
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
        Json row = Json::array();
        for (Eigen::Index k = 0; k < m.cols(); ++k) {
            row.push_back(m(i, k));
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

Json pose_json(const Eigen::Isometry3d& T) {
    const Eigen::Quaterniond q(T.linear());
    return {{"position_mm", vector_json(T.translation())},
            {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}},
            {"matrix", matrix_json(T.matrix())}};
}

Eigen::MatrixXd matrix_of(const Json& json, Eigen::Index rows) {
    Eigen::MatrixXd m(rows, rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
        for (Eigen::Index k = 0; k < rows; ++k) {
            m(i, k) = json.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(k)).get<double>();
        }
    }
    return m;
}

}  // namespace seampath
