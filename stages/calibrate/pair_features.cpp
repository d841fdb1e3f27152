#include "stages/calibrate/pair_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "stages/geometry/parallel.hpp"

namespace seampath::calibrating {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kAngleBins = 12;            // of 15 degrees, as Drost's
constexpr std::size_t kTurnBins = 30;     // of 12 degrees
constexpr std::size_t kReferences = 400;  // in the scene
constexpr std::size_t kPeaks = 3;         // taken from each reference
constexpr double kSamePlane = 0.2;        // cosine to the normals, and sine between them
constexpr double kSameTurn = 0.3;         // rad, of poses that are one
constexpr double kSameShift = 2.5;        // of the spacing

// Takes the normal to X and the point to the origin.
Isometry3d local_frame(const Surfel& s) {
    Isometry3d T = Isometry3d::Identity();
    T.linear() = Eigen::Quaterniond::FromTwoVectors(s.n, Vector3d::UnitX()).toRotationMatrix();
    T.translation() = -T.linear() * s.p;
    return T;
}

// Turn about X that takes q to the half-plane y > 0, z = 0.
float turn_of(const Vector3d& q) {
    return static_cast<float>(-std::atan2(q.z(), q.y()));
}

/// Bins of Drost's feature: distance, the angles of both normals to it, and that between the normals.
class PairBins {
public:
    PairBins(double spacing, double longest)
        : spacing_(spacing), distances_(static_cast<std::size_t>(longest / spacing) + 1) {}
    std::size_t size() const { return distances_ * kAngleBins * kAngleBins * kAngleBins; }
    std::optional<std::size_t> bin(const Surfel& a, const Surfel& b) const {
        const Vector3d d = b.p - a.p;
        const double length = d.norm();
        const auto k = static_cast<std::size_t>(length / spacing_);
        if (k >= distances_ || length < spacing_ / 2) {
            return std::nullopt;
        }
        const double ca = a.n.dot(d) / length, cb = b.n.dot(d) / length, cn = a.n.dot(b.n);
        if (std::abs(ca) < kSamePlane && std::abs(cb) < kSamePlane && cn > 1 - kSamePlane * kSamePlane) {
            return std::nullopt;
        }
        return ((k * kAngleBins + angle(ca)) * kAngleBins + angle(cb)) * kAngleBins + angle(cn);
    }

private:
    static std::size_t angle(double cosine) {
        const double a = std::acos(std::clamp(cosine, -1.0, 1.0));
        return std::min<std::size_t>(kAngleBins - 1, static_cast<std::size_t>(a / std::numbers::pi * kAngleBins));
    }
    double spacing_;
    std::size_t distances_;
};

struct PartPair {
    std::uint16_t reference;
    float turn;
};

/// Every pair of the part, by bin.
struct PairTable {
    std::vector<std::uint32_t> start;
    std::vector<PartPair> pairs;
};

PairTable table_of(std::span<const Surfel> part, const PairBins& bins) {
    PairTable table;
    std::vector<std::pair<std::uint32_t, PartPair>> all;
    for (std::size_t i = 0; i < part.size(); ++i) {
        const Isometry3d T = local_frame(part[i]);
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto bin = i == k ? std::nullopt : bins.bin(part[i], part[k]);
            if (bin) {
                all.push_back(
                    {static_cast<std::uint32_t>(*bin), {static_cast<std::uint16_t>(i), turn_of(T * part[k].p)}});
            }
        }
    }
    table.start.assign(bins.size() + 1, 0);
    for (const auto& [bin, pair] : all) {
        ++table.start[bin + 1];
    }
    std::partial_sum(table.start.begin(), table.start.end(), table.start.begin());
    std::vector<std::uint32_t> next(table.start.begin(), table.start.end() - 1);
    table.pairs.resize(all.size());
    for (const auto& [bin, pair] : all) {
        table.pairs[next[bin]++] = pair;
    }
    return table;
}

// The poses that the pairs of one surfel of the scene speak for most.
std::vector<PairPose> poses_at(std::span<const Surfel> part, std::span<const Surfel> scene, std::size_t reference,
                               const PairBins& bins, const PairTable& table) {
    std::vector<float> votes(part.size() * kTurnBins, 0);
    const Isometry3d T = local_frame(scene[reference]);
    for (std::size_t k = 0; k < scene.size(); ++k) {
        const auto bin = k == reference ? std::nullopt : bins.bin(scene[reference], scene[k]);
        if (!bin || table.start[*bin] == table.start[*bin + 1]) {
            continue;
        }
        const float turn = turn_of(T * scene[k].p);
        // A bin that many pairs share tells little.
        const float weight = 1 / std::sqrt(static_cast<float>(table.start[*bin + 1] - table.start[*bin]));
        for (std::uint32_t i = table.start[*bin]; i < table.start[*bin + 1]; ++i) {
            float t = (table.pairs[i].turn - turn) / static_cast<float>(2 * std::numbers::pi);
            t -= std::floor(t);
            const auto at = std::min<std::size_t>(kTurnBins - 1, static_cast<std::size_t>(t * kTurnBins));
            votes[table.pairs[i].reference * kTurnBins + at] += weight;
        }
    }
    std::vector<PairPose> poses;
    const Isometry3d back = T.inverse();
    for (std::size_t peak = 0; peak < kPeaks; ++peak) {
        const auto best = std::max_element(votes.begin(), votes.end());
        const auto at = static_cast<std::size_t>(best - votes.begin());
        const double turn = 2 * std::numbers::pi * (static_cast<double>(at % kTurnBins) + 0.5) / kTurnBins;
        poses.push_back({back * Eigen::AngleAxisd(turn, Vector3d::UnitX()) * local_frame(part[at / kTurnBins]), *best});
        *best = 0;
    }
    return poses;
}

}  // namespace

std::vector<PairPose> pair_feature_poses(std::span<const Surfel> part, std::span<const Surfel> scene, double spacing,
                                         std::size_t most) {
    if (part.empty() || scene.empty()) {
        return {};
    }
    Eigen::AlignedBox3d box;
    for (const Surfel& s : part) {
        box.extend(s.p);
    }
    const PairBins bins(spacing, box.diagonal().norm());
    const PairTable table = table_of(part, bins);
    const std::size_t references = std::min(kReferences, scene.size());
    std::vector<std::vector<PairPose>> found(references);
    parallel_for(references, 1,
                 [&](std::size_t i) { found[i] = poses_at(part, scene, i * scene.size() / references, bins, table); });
    std::vector<PairPose> all, distinct;
    for (const auto& poses : found) {
        all.insert(all.end(), poses.begin(), poses.end());
    }
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.votes > b.votes; });
    const Vector3d middle = box.center();
    for (const PairPose& pose : all) {
        const auto same = std::find_if(distinct.begin(), distinct.end(), [&](const PairPose& d) {
            const double shift = (d.base_from_part * middle - pose.base_from_part * middle).norm();
            const Eigen::AngleAxisd turn(d.base_from_part.linear().transpose() * pose.base_from_part.linear());
            return shift < kSameShift * spacing && turn.angle() < kSameTurn;
        });
        if (same != distinct.end()) {
            same->votes += pose.votes;
        } else {
            distinct.push_back(pose);
        }
    }
    std::stable_sort(distinct.begin(), distinct.end(), [](const auto& a, const auto& b) { return a.votes > b.votes; });
    distinct.resize(std::min(most, distinct.size()));
    return distinct;
}

}  // namespace seampath::calibrating
