#include "stages/geometry/pieces.hpp"

#include <cstddef>

#include "stages/error.hpp"

namespace seampath {
namespace {

/// The symmetric function of three arguments, affine in each, that is the cubic where they are equal.
Eigen::Vector3d blossom(const std::array<Eigen::Vector3d, 4>& c, double p, double q, double r) {
    return c[0] + c[1] * ((p + q + r) / 3) + c[2] * ((p * q + q * r + r * p) / 3) + c[3] * (p * q * r);
}

/// Knots without end, those of a periodic curve over and over, each with the piece that begins at its break.
class Knots {
public:
    Knots(const CubicPieces& pieces, bool periodic) : periodic_(periodic) {
        const std::size_t n = pieces.coefficients.size();
        for (std::size_t k = 0; k < n; ++k) {
            add(pieces.breaks[k], k, periodic || k > 0 ? pieces.joints[k] : kEnd);
        }
        period_ = pieces.breaks[n] - pieces.breaks[0];
        ring_ = std::ssize(knots);
        add(pieces.breaks[n], n, periodic ? 1 : kEnd);
    }

    double at(std::ptrdiff_t j) const { return knots[index(j)] + shift(j); }
    std::size_t piece(std::ptrdiff_t j) const { return piece_[index(j)]; }
    double shift(std::ptrdiff_t j) const { return periodic_ ? static_cast<double>(turns(j)) * period_ : 0; }
    std::size_t controls() const { return periodic_ ? static_cast<std::size_t>(ring_) : knots.size() - kEnd; }

    std::vector<double> knots;

private:
    static constexpr int kEnd = 4;

    void add(double knot, std::size_t piece, int times) {
        knots.insert(knots.end(), static_cast<std::size_t>(times), knot);
        piece_.insert(piece_.end(), static_cast<std::size_t>(times), piece);
    }
    std::ptrdiff_t turns(std::ptrdiff_t j) const { return j >= 0 ? j / ring_ : -((ring_ - 1 - j) / ring_); }
    std::size_t index(std::ptrdiff_t j) const { return static_cast<std::size_t>(periodic_ ? j - turns(j) * ring_ : j); }

    bool periodic_;
    double period_ = 0;
    std::ptrdiff_t ring_ = 0;
    std::vector<std::size_t> piece_;
};

}  // namespace

CubicBSpline as_bspline(const CubicPieces& pieces, bool periodic) {
    ensure(!pieces.coefficients.empty() && pieces.breaks.size() == pieces.coefficients.size() + 1 &&
               pieces.joints.size() == pieces.coefficients.size(),
           "a break before each piece and one at the end, a joint for each piece");
    const Knots t(pieces, periodic);
    CubicBSpline curve;
    curve.periodic = periodic;
    for (std::size_t c = 0; c < t.controls(); ++c) {
        // The basis function of this control point reaches over four spans; of the pieces there the widest loses the
        // fewest digits.
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(c) - (periodic ? 3 : 0);
        std::ptrdiff_t widest = first;
        for (std::ptrdiff_t j = first + 1; j < first + 4; ++j) {
            widest = t.at(j + 1) - t.at(j) > t.at(widest + 1) - t.at(widest) ? j : widest;
        }
        const double from = pieces.breaks[t.piece(widest)] + t.shift(widest);
        curve.control.push_back(blossom(pieces.coefficients[t.piece(widest)], t.at(first + 1) - from,
                                        t.at(first + 2) - from, t.at(first + 3) - from));
    }
    curve.knots = t.knots;
    return curve;
}

}  // namespace seampath
