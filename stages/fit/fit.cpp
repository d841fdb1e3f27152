#include "stages/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

constexpr int kFootPointRounds = 4;      // the parameters settle to rounding level after three
constexpr double kTukey = 4.685;
constexpr std::size_t kLeastSpans = 4;

// Chord length along the points; for a closed seam one more, back to the first.
std::vector<double> chord_length(const Seam& seam) {
    std::vector<double> u{0};
    for (std::size_t i = 1; i < seam.points.size() + (seam.closed ? 1 : 0); ++i) {
        u.push_back(u.back() + (seam.points[i % seam.points.size()].p - seam.points[i - 1].p).norm());
    }
    return u;
}

struct Data {
    std::vector<Eigen::Vector3d> p;
    std::vector<double> u, weight;      // weight: 1/sigma
};

CubicBSpline with_knots(const std::vector<double>& breaks, bool periodic) {
    CubicBSpline curve;
    curve.periodic = periodic;
    if (periodic) {
        curve.knots = breaks;
        curve.control.resize(breaks.size() - 1);
    } else {
        curve.knots.assign(3, breaks.front());
        curve.knots.insert(curve.knots.end(), breaks.begin(), breaks.end());
        curve.knots.insert(curve.knots.end(), 3, breaks.back());
        curve.control.resize(curve.knots.size() - 4);
    }
    return curve;
}

// Weighted linear least squares for the control points; `robust` are extra weights, one per point.
void solve_control(CubicBSpline& curve, const Data& data, const std::vector<double>& robust) {
    const auto n = static_cast<Eigen::Index>(curve.control.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(n, 3);
    for (std::size_t i = 0; i < data.p.size(); ++i) {
        const CubicBasis basis = cubic_basis(curve.knots, curve.control.size(), curve.periodic, data.u[i]);
        const double w = data.weight[i] * data.weight[i] * robust[i];
        for (int r = 0; r < 4; ++r) {
            const auto row = static_cast<Eigen::Index>(basis.control[r]);
            for (int c = 0; c < 4; ++c) {
                A(row, static_cast<Eigen::Index>(basis.control[c])) += w * basis.value[r] * basis.value[c];
            }
            b.row(row) += w * basis.value[r] * data.p[i].transpose();
        }
    }
    // A trace of smoothing keeps spans without weight (all outliers, a bridged gap) from floating.
    const double trace = 1e-9 * A.trace() / static_cast<double>(n);
    for (Eigen::Index i = 0; i < n - (curve.periodic ? 0 : 2); ++i) {
        const Eigen::Index k[3] = {i, (i + 1) % n, (i + 2) % n};
        const double d[3] = {1, -2, 1};
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) {
                A(k[r], k[c]) += trace * d[r] * d[c];
            }
        }
    }
    const Eigen::MatrixXd x = A.ldlt().solve(b);
    ensure(x.allFinite(), "control points of a least-squares spline are finite");
    for (Eigen::Index i = 0; i < n; ++i) {
        curve.control[static_cast<std::size_t>(i)] = x.row(i).transpose();
    }
}

// Least squares of the orthogonal distances: control points and foot points in turn, Tukey weights on distance / sigma.
CubicBSpline orthogonal_fit(Data& data, const std::vector<double>& breaks, bool periodic, std::vector<double>& residual) {
    CubicBSpline curve = with_knots(breaks, periodic);
    std::vector<double> robust(data.p.size(), 1);
    residual.assign(data.p.size(), 0);
    for (int round = 0; round < kFootPointRounds; ++round) {
        solve_control(curve, data, robust);
        std::vector<double> relative;
        for (std::size_t i = 0; i < data.p.size(); ++i) {
            // The ends of an open curve stay where the seam's ends are.
            if (periodic || (i > 0 && i + 1 < data.p.size())) {
                data.u[i] = nearest_parameter(curve, data.p[i], data.u[i]);
            }
            residual[i] = (position(curve, data.u[i]) - data.p[i]).norm();
            relative.push_back(residual[i] * data.weight[i]);
        }
        const double scale = std::max(1.0, 1.2 * quantile(relative, 0.5));
        for (std::size_t i = 0; i < data.p.size(); ++i) {
            const double x = residual[i] * data.weight[i] / (kTukey * scale);
            robust[i] = x < 1 ? (1 - x * x) * (1 - x * x) : 0;
        }
    }
    return curve;
}

// Spans, as indices of breaks, in which the residuals are larger than sigma explains and which can be halved.
std::set<std::size_t> poor_spans(const Data& data, const std::vector<double>& residual, const std::vector<double>& breaks, double limit) {
    std::vector<double> square(breaks.size(), 0), count(breaks.size(), 0);
    for (std::size_t i = 0; i < data.p.size(); ++i) {
        const auto above = std::upper_bound(breaks.begin(), breaks.end(), data.u[i]) - breaks.begin();
        const auto span = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - 1, 0, static_cast<std::ptrdiff_t>(breaks.size()) - 2));
        const double r = std::min(residual[i] * data.weight[i], 5.0);
        square[span] += r * r;
        count[span] += 1;
    }
    std::set<std::size_t> poor;
    for (std::size_t span = 0; span + 1 < breaks.size(); ++span) {
        if (count[span] >= 6 && std::sqrt(square[span] / count[span]) > limit) {
            poor.insert(span);
        }
    }
    return poor;
}

// Every few nodes to begin with: a cubic follows a bend that takes several chords, but hardly more than a third of a right
// angle; what it can't follow at all would pass for outliers.
std::vector<double> first_breaks(const Seam& seam, const std::vector<double>& u, const Nodes& nodes, bool closed) {
    constexpr std::size_t kChordsPerSpan = 4;
    constexpr double kCosMostTurn = 0.87;      // 30 degrees
    std::vector<double> breaks{u.front()};
    const auto chord = [&](std::size_t k) { return (seam.points[nodes.index[k]].p - seam.points[nodes.index[k - 1]].p).normalized().eval(); };
    std::size_t last = 0;
    for (std::size_t k = 1; k + 1 < nodes.index.size(); ++k) {
        const bool turned = chord(last + 1).dot(chord(k + 1)) < kCosMostTurn;
        if (u[nodes.index[k]] > breaks.back() && (turned || (k - last >= kChordsPerSpan && k + kChordsPerSpan / 2 < nodes.index.size()))) {
            breaks.push_back(u[nodes.index[k]]);
            last = k;
        }
    }
    breaks.push_back(u.back());
    while (closed && breaks.size() < kLeastSpans + 1) {
        std::vector<double> finer;
        for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
            finer.push_back(breaks[i]);
            finer.push_back(0.5 * (breaks[i] + breaks[i + 1]));
        }
        finer.push_back(breaks.back());
        breaks = finer;
    }
    return breaks;
}

// Normals averaged over a few neighbours: a torch should not shake with the noise of single fits.
std::vector<FlankSample> flank_samples(const Seam& seam, const SeamModel& model, const Data& data) {
    constexpr std::ptrdiff_t kHalf = 3;
    const ArcLength arc(model.curve);
    const auto n = static_cast<std::ptrdiff_t>(seam.points.size());
    std::vector<FlankSample> samples;
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        FlankSample sample;
        sample.station_mm = arc.station(data.u[static_cast<std::size_t>(i)]);
        sample.n1 = sample.n2 = Eigen::Vector3d::Zero();
        const std::ptrdiff_t half = seam.closed ? kHalf : std::min({kHalf, i, n - 1 - i});
        for (std::ptrdiff_t k = -half; k <= half; ++k) {
            const SeamPoint& q = seam.points[static_cast<std::size_t>((i + k + n) % n)];
            sample.n1 += q.n1 / (q.sigma_mm * q.sigma_mm);
            sample.n2 += q.n2 / (q.sigma_mm * q.sigma_mm);
        }
        sample.n1.normalize();
        sample.n2.normalize();
        const SeamPoint& p = seam.points[static_cast<std::size_t>(i)];
        sample.sigma_mm = p.sigma_mm;
        sample.modelled = p.modelled;
        samples.push_back(sample);
    }
    std::stable_sort(samples.begin(), samples.end(), [](const FlankSample& a, const FlankSample& b) { return a.station_mm < b.station_mm; });
    return samples;
}

}  // namespace

Fields describe(FitOptions& o) {
    return {{"max_residual_sigma", &o.max_residual_sigma,
             "largest rms of residual / sigma between two knots before the span is halved", above(0)}};
}

SeamModel fit(const Seam& seam, const Nodes& nodes, const FitOptions& options) {
    if (seam.points.size() < 6) {
        throw InputError("fit: the seam has " + std::to_string(seam.points.size()) + " points; at least 6 are needed; lower extract.station_mm");
    }
    Data data;
    data.u = chord_length(seam);
    std::vector<double> breaks = first_breaks(seam, data.u, nodes, seam.closed);
    const double period = data.u.back();
    data.u.resize(seam.points.size());
    std::vector<double> sigma;
    for (const SeamPoint& point : seam.points) {
        sigma.push_back(point.sigma_mm);
    }
    const double least_sigma = std::max(1e-6, 0.1 * quantile(sigma, 0.5));
    for (const SeamPoint& point : seam.points) {
        data.p.push_back(point.p);
        data.weight.push_back(1 / std::max(point.sigma_mm, least_sigma));
    }
    const std::vector<double> chord = data.u;
    std::vector<double> residual;
    SeamModel model;
    model.kind = seam.kind;
    model.closed = seam.closed;
    while (true) {
        data.u = chord;
        model.curve = orthogonal_fit(data, breaks, seam.closed, residual);
        const std::set<std::size_t> poor = poor_spans(data, residual, breaks, options.max_residual_sigma);
        if (poor.empty() || 2 * breaks.size() > seam.points.size()) {
            break;
        }
        std::vector<double> finer;
        for (std::size_t i = 0; i < breaks.size(); ++i) {
            finer.push_back(breaks[i]);
            if (poor.contains(i)) {
                finer.push_back(0.5 * (breaks[i] + breaks[i + 1]));
            }
        }
        breaks = std::move(finer);
    }
    if (!(period > 0)) {
        throw InputError("fit: the seam has no length; all its points coincide; check the scan");
    }
    model.length_mm = ArcLength(model.curve).length();
    model.flanks = flank_samples(seam, model, data);
    double sum = 0;
    for (const double r : residual) {
        sum += r * r;
        model.residual_max_mm = std::max(model.residual_max_mm, r);
    }
    model.residual_rms_mm = std::sqrt(sum / static_cast<double>(residual.size()));
    model.degrees_of_freedom = 3 * static_cast<double>(model.curve.control.size());
    return model;
}

}  // namespace seampath
