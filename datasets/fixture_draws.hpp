#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "datasets/rng.hpp"

namespace seampath {

/// Random numbers one after the other from a stream.
class Draws {
public:
    Draws(std::uint64_t seed, std::uint64_t stream) : random_(seed, stream) {}
    double uniform(double low, double high) { return random_.uniform(next_++, low, high); }
    double normal() { return random_.normal(next_++); }
    Eigen::Vector3d direction() {
        Eigen::Vector3d v;
        do {
            v = Eigen::Vector3d(normal(), normal(), normal());
        } while (!(v.norm() > 1e-3));
        return v.normalized();
    }
    /// Any turn, and an origin within so many mm of 0 along each axis.
    Eigen::Isometry3d pose(double reach) {
        Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
        const Eigen::Vector4d q(normal(), normal(), normal(), normal());
        T.linear() = Eigen::Quaterniond(q.normalized()).toRotationMatrix();
        T.translation() = Eigen::Vector3d(uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach));
        return T;
    }

private:
    Random random_;
    std::uint64_t next_ = 0;
};

}  // namespace seampath
