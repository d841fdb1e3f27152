#pragma once

#include <cmath>

#include "datasets/dataset.hpp"
#include "datasets/score.hpp"
#include "stages/extract/extract.hpp"
#include "tests/accuracy/measure.hpp"

/// Joints of plates before the usual scanner, small so that tests are quick, and how well they are found.
namespace seampath {

inline SceneOptions small_plates(SceneKind kind, Course course = Course::straight) {
    SceneOptions o;
    o.kind = kind;
    o.course = course;
    o.length_mm = 70;
    o.margin_mm = 18;
    o.overlap_mm = 12;
    o.plate_thickness_mm = 6;
    o.amplitude_mm = 6;
    o.wavelength_mm = 70;
    return o;
}

/// Of one scan: the score of the extracted points, and how many of them keep their sigma.
struct Found {
    Extraction extraction;
    Score score;
    double within_1_sigma = 0, within_2_sigma = 0;
};

inline Found find_in(const SceneOptions& scene, std::uint64_t seed, const ExtractOptions& options = {}) {
    const Dataset dataset = make_dataset(scene, {}, seed);
    Found found;
    found.extraction = extract(scan_of(dataset), options);
    found.score = score(found.extraction.seams, dataset.truth);
    double points = 0;
    for (const Seam& seam : found.extraction.seams) {
        for (const SeamPoint& point : seam.points) {
            double nearest = 1e300, off = 1e300;
            for (const TruthSeam& truth : dataset.truth.seams) {
                for (const TruthPoint& t : truth.points) {
                    const Eigen::Vector3d d = point.p - t.p;
                    if (d.squaredNorm() < nearest) {
                        nearest = d.squaredNorm();
                        off = (d - d.dot(t.tangent) * t.tangent).norm();
                    }
                }
            }
            points += 1;
            found.within_1_sigma += off < point.sigma_mm;
            found.within_2_sigma += off < 2 * point.sigma_mm;
        }
    }
    found.within_1_sigma /= std::max(1.0, points);
    found.within_2_sigma /= std::max(1.0, points);
    return found;
}

}  // namespace seampath
