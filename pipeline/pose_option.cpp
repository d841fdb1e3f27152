#include "pipeline/pose_option.hpp"

namespace seampath {

Eigen::Isometry3d pose_of(const std::vector<double>& option) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = Eigen::Vector3d(option.at(0), option.at(1), option.at(2));
    pose.linear() =
        Eigen::Quaterniond(option.at(3), option.at(4), option.at(5), option.at(6)).normalized().toRotationMatrix();
    return pose;
}

}  // namespace seampath
