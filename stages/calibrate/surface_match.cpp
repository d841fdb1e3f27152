#include "stages/calibrate/surface_match.hpp"

#include <algorithm>
#include <cmath>

#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath::calibrating {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kTukeyWidth = 4.685;      // 95 % efficient for Gaussian noise
constexpr double kSigmaOfMedian = 1.4826;  // of absolute Gaussian residuals
constexpr double kShrink = 0.6;
constexpr std::size_t kPointsAThread = 32768;  // fewer are matched sooner than a thread begins
constexpr int kRoundsAWidth = 6, kWidths = 30;

double scale_of(const std::vector<Contact>& contacts) {
    std::vector<double> distance;
    distance.reserve(contacts.size());
    for (const Contact& c : contacts) {
        distance.push_back(std::abs(c.distance));
    }
    return kSigmaOfMedian * quantile(distance, 0.5);
}

Reference reference_of_contacts(const std::vector<Contact>& contacts, std::span<const SidedPoint> points) {
    Reference reference;
    const double n = static_cast<double>(contacts.size());
    double squares = 0;
    for (const Contact& c : contacts) {
        reference.about += points[c.point].p / n;
    }
    for (const Contact& c : contacts) {
        squares += (points[c.point].p - reference.about).squaredNorm() / n;
    }
    reference.length = squares > 0 ? std::sqrt(squares) : 1;
    return reference;
}

Sums weighted_sums(const FrameFit& fit, std::span<const SidedPoint> points) {
    Sums sums;
    for (const Contact& c : fit.contacts) {
        const double weight = tukey_weight(c.distance / fit.gate_mm);
        const Vector6 J = contact_row(c, points[c.point].p, fit.reference.about);
        sums.H += weight * J * J.transpose();
        sums.g -= weight * c.distance * J;
        sums.count += weight > 0;
    }
    return sums;
}

// One step; its length in mm.
double step_of(const TargetSurface& surface, std::span<const SidedPoint> points, const Seeing& seeing,
               double weak_ratio, FrameFit& fit) {
    fit.contacts = surface.contacts(points, fit.base_from_part, fit.gate_mm, seeing);
    if (fit.contacts.size() < 6) {
        return 0;
    }
    fit.reference = reference_of_contacts(fit.contacts, points);
    const std::vector<Sums> levels{weighted_sums(fit, points)};
    fit.last = step_by_level(levels, fit.reference.length, weak_ratio);
    fit.base_from_part = displaced(fit.base_from_part, fit.last.step, fit.reference.about);
    return fit.last.step.head<3>().norm() + fit.reference.length * fit.last.step.tail<3>().norm();
}

}  // namespace

Vector6 contact_row(const Contact& contact, const Vector3d& p, const Vector3d& about) {
    Vector6 J;
    J << -contact.normal, -(p - about).cross(contact.normal);
    return J;
}

std::vector<Contact> TargetSurface::contacts(std::span<const SidedPoint> points, const Isometry3d& T, double gate,
                                             const Seeing& seeing) const {
    const Isometry3d back = T.inverse();
    const Sights about = sights(seeing, T);
    const double lateral = 0.8 * spacing_;  // half the diagonal of a surfel's cell, and a little
    std::vector<Contact> found(points.size());
    std::vector<std::uint8_t> touches(points.size(), 0);
    parallel_for(points.size(), kPointsAThread, [&](std::size_t i) {
        const Vector3d q = back * points[i].p, side = back.linear() * points[i].side;
        double best = gate;
        for (const std::uint32_t k : grid_.near(q)) {
            const Surfel& s = surfels_[k];
            const double d = s.distance(q), along2 = (q - s.p).squaredNorm() - d * d;
            if (std::abs(d) < best && along2 < lateral * lateral && s.n.dot(side) > seeing.least_cosine &&
                (s.sights & about).any()) {
                best = std::abs(d);
                found[i] = {i, k, d, Vector3d::Zero()};
                touches[i] = 1;
            }
        }
        if (touches[i]) {
            found[i].normal = T.linear() * surfels_[found[i].surfel].normal(q);
        }
    });
    std::vector<Contact> contacts;
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (touches[i]) {
            contacts.push_back(found[i]);
        }
    }
    return contacts;
}

FrameFit fit_to_surface(const TargetSurface& surface, std::span<const SidedPoint> points, const Isometry3d& start,
                        double first_gate, double least_scale_mm, const Seeing& seeing, double weak_ratio) {
    FrameFit fit;
    fit.base_from_part = start;
    fit.gate_mm = first_gate;
    fit.weak_ratio = weak_ratio;
    for (int width = 0; width < kWidths; ++width) {
        for (int round = 0; round < kRoundsAWidth; ++round) {
            if (step_of(surface, points, seeing, weak_ratio, fit) < 1e-3 * fit.gate_mm) {
                break;
            }
        }
        if (fit.contacts.size() < 6) {
            return fit;
        }
        fit.scale_mm = std::max(least_scale_mm, scale_of(fit.contacts));
        const double wanted = std::max(kShrink * fit.gate_mm, kTukeyWidth * fit.scale_mm);
        if (wanted >= fit.gate_mm) {
            break;
        }
        fit.gate_mm = wanted;
    }
    for (int round = 0; round < kWidths; ++round) {  // with the width at rest, to the end
        if (step_of(surface, points, seeing, weak_ratio, fit) < 1e-5 * fit.scale_mm) {
            break;
        }
    }
    fit.contacts = surface.contacts(points, fit.base_from_part, fit.gate_mm, seeing);
    return fit;
}

}  // namespace seampath::calibrating
