#include "pipeline/report_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Eigenvalues>

namespace seampath {
namespace {

/// Directions that are tried, how many of the best are looked at for what hides the seams, and points that judge them.
constexpr int kDirections = 400;
constexpr std::size_t kShortList = 32, kJudges = 300;

/// The coarse picture in which is seen what hides what: so many cells a side, and this share of the scan points.
constexpr int kCells = 96;
constexpr std::size_t kPointStep = 8;

/// A point of a seam, relative to the scene's centre, that says from where it is well seen.
struct Judge {
    Eigen::Vector3d p, n1, n2, tangent;
};

struct Candidate {
    Eigen::Vector3d toward;
    double score = 0;
};

std::vector<Judge> judges_of(std::span<const Seam> seams, const Eigen::Vector3d& centre) {
    std::size_t total = 0;
    for (const Seam& seam : seams) {
        total += seam.points.size();
    }
    const std::size_t step = total / kJudges + 1;
    std::vector<Judge> judges;
    for (const Seam& seam : seams) {
        for (std::size_t i = 0; i < seam.points.size(); i += step) {
            const SeamPoint& point = seam.points[i];
            judges.push_back({point.p - centre, point.n1, point.n2, point.n1.cross(point.n2).normalized()});
        }
    }
    return judges;
}

/// How well one point is seen: the smaller of the sines at which its flanks are looked at (beyond 40 degrees more is no
/// better), and a little for a seam that does not lie straight across the view, which gives depth.
double value(const Judge& judge, const Eigen::Vector3d& toward) {
    constexpr double kEnough = 0.64, kDepthWeight = 0.2;
    const double open = std::min({judge.n1.dot(toward), judge.n2.dot(toward), kEnough});
    return open > 0 ? open * (1 + kDepthWeight * std::abs(judge.tangent.dot(toward))) : 0;
}

/// The nearest scan point in each cell of a picture taken from `toward`.
class DepthPicture {
public:
    DepthPicture(const ViewScene& scene, const Eigen::Vector3d& toward)
        : toward_(toward.cast<float>()),
          right_(toward.unitOrthogonal().cast<float>()),
          up_(toward_.cross(right_)),
          cell_(static_cast<float>(2.4 * scene.radius_mm / kCells)),
          nearest_(std::size_t{kCells} * kCells, -std::numeric_limits<float>::max()) {
        for (const ViewCloud& cloud : scene.clouds) {
            for (std::size_t i = 0; i < cloud.points.size(); i += kPointStep) {
                if (const int k = index(cloud.points[i]); k >= 0) {
                    nearest_[static_cast<std::size_t>(k)] =
                        std::max(nearest_[static_cast<std::size_t>(k)], toward_.dot(cloud.points[i]));
                }
            }
        }
    }

    /// Whether nothing stands before the seam there. It is looked for in the air above it, where its own flanks don't
    /// hide it.
    bool sees(const Judge& judge) const {
        const Eigen::Vector3f p = (judge.p + 2.0 * static_cast<double>(cell_) * (judge.n1 + judge.n2)).cast<float>();
        const int k = index(p);
        return k < 0 || nearest_[static_cast<std::size_t>(k)] < toward_.dot(p) + 2 * cell_;
    }

private:
    int index(const Eigen::Vector3f& p) const {
        const auto x = static_cast<int>(std::floor(right_.dot(p) / cell_)) + kCells / 2;
        const auto y = static_cast<int>(std::floor(up_.dot(p) / cell_)) + kCells / 2;
        return x >= 0 && x < kCells && y >= 0 && y < kCells ? y * kCells + x : -1;
    }

    Eigen::Vector3f toward_, right_, up_;
    float cell_;
    std::vector<float> nearest_;
};

Eigen::Vector3d best_direction(const std::vector<Judge>& judges, const ViewScene& scene) {
    std::vector<Candidate> candidates;
    for (int k = 0; k < kDirections; ++k) {
        // Fibonacci's sphere: even, and the same on every machine.
        const double z = 1 - (2 * k + 1.0) / kDirections, turn = k * std::numbers::pi * (3 - std::sqrt(5.0));
        const double r = std::sqrt(1 - z * z);
        Candidate candidate{{r * std::cos(turn), r * std::sin(turn), z}};
        for (const Judge& judge : judges) {
            candidate.score += value(judge, candidate.toward);
        }
        candidates.push_back(candidate);
    }
    const auto better = [](const Candidate& a, const Candidate& b) { return a.score > b.score; };
    std::stable_sort(candidates.begin(), candidates.end(), better);
    candidates.resize(kShortList);
    for (Candidate& candidate : candidates) {
        const DepthPicture picture(scene, candidate.toward);
        candidate.score = 0;
        for (const Judge& judge : judges) {
            candidate.score += picture.sees(judge) ? value(judge, candidate.toward) : 0;
        }
    }
    return std::min_element(candidates.begin(), candidates.end(), better)->toward;
}

/// The flank normal that most others are near to; between equals, the one that points higher.
Eigen::Vector3d common_normal(const std::vector<Judge>& judges) {
    std::vector<Eigen::Vector3d> normals;
    for (const Judge& judge : judges) {
        normals.push_back(judge.n1);
        normals.push_back(judge.n2);
    }
    Eigen::Vector3d common = normals.front();
    double most = -1;
    for (const Eigen::Vector3d& candidate : normals) {
        double votes = 1e-3 * candidate.z();
        for (const Eigen::Vector3d& n : normals) {
            votes += std::pow(std::max(0.0, n.dot(candidate)), 8) / static_cast<double>(normals.size());
        }
        if (votes > most + 1e-9) {
            most = votes;
            common = candidate;
        }
    }
    return common;
}

/// The common normal stands upright, or, where it points at the camera, the seams lie across the picture.
Eigen::Vector3d upright(const std::vector<Judge>& judges, const Eigen::Vector3d& toward) {
    const Eigen::Vector3d normal = common_normal(judges);
    const Eigen::Vector3d rise = normal - toward * toward.dot(normal);
    if (rise.norm() > 0.35) {
        return rise.normalized();
    }
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Judge& judge : judges) {
        middle += judge.p / static_cast<double>(judges.size());
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Judge& judge : judges) {
        const Eigen::Vector3d d = judge.p - middle - toward * toward.dot(judge.p - middle);
        spread += d * d.transpose();
    }
    const Eigen::Vector3d across = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
    const Eigen::Vector3d up = toward.cross(across).normalized();
    return up.z() < 0 ? Eigen::Vector3d(-up) : up;
}

}  // namespace

ViewCamera best_camera(std::span<const Seam> seams, const Scan& scan, const ViewScene& scene) {
    const std::vector<Judge> judges = judges_of(seams, scene.centre);
    if (!judges.empty()) {
        const Eigen::Vector3d toward = best_direction(judges, scene);
        return {toward, upright(judges, toward)};
    }
    const Eigen::Vector3d from =
        scan.sensor_mm ? Eigen::Vector3d(*scan.sensor_mm - scene.centre) : Eigen::Vector3d::Zero();
    const Eigen::Vector3d toward = (from.norm() > 1 ? from : Eigen::Vector3d(1, -1.6, 1.2)).normalized();
    const Eigen::Vector3d axis = std::abs(toward.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
    return {toward, (axis - toward * toward.dot(axis)).normalized()};
}

}  // namespace seampath
