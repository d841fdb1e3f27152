#include "stages/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "stages/error.hpp"
#include "stages/fit/cornered.hpp"
#include "stages/fit/interpolated.hpp"
#include "stages/fit/saddle_model.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/smoothed.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Normals = std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>;

// Averaged over a few neighbours: a torch should not shake with the noise of single fits.
Normals averaged_normals(const Seam& seam) {
    constexpr std::ptrdiff_t kHalf = 3;
    const auto n = static_cast<std::ptrdiff_t>(seam.points.size());
    Normals normals;
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        Eigen::Vector3d n1 = Eigen::Vector3d::Zero(), n2 = n1;
        const std::ptrdiff_t half = seam.closed ? kHalf : std::min({kHalf, i, n - 1 - i});
        for (std::ptrdiff_t k = -half; k <= half; ++k) {
            const SeamPoint& q = seam.points[static_cast<std::size_t>((i + k + n) % n)];
            n1 += q.n1 / (q.sigma_mm * q.sigma_mm);
            n2 += q.n2 / (q.sigma_mm * q.sigma_mm);
        }
        normals.emplace_back(n1.normalized(), n2.normalized());
    }
    return normals;
}

// What 19 of 20 distances from the model stay below, in the plane across it.
std::vector<BandSample> band_of(const std::vector<CurveSigma>& sigma, const ArcLength& arc) {
    const double factor = std::sqrt(-2 * std::log(0.05));  // of a direction's sigma (Rayleigh)
    std::vector<BandSample> band;
    for (const auto& [u, sigma_mm] : sigma) {
        band.push_back({arc.station(u), factor * sigma_mm});
    }
    return band;
}

std::vector<FlankSample> flank_samples(const Seam& seam, const ArcLength& arc, const std::vector<double>& u,
                                       const Normals& normals) {
    std::vector<FlankSample> samples;
    for (std::size_t i = 0; i < u.size(); ++i) {
        const SeamPoint& p = seam.points[i];
        samples.push_back({arc.station(u[i]), normals[i].first, normals[i].second, p.sigma_mm, p.modelled});
    }
    std::stable_sort(samples.begin(), samples.end(),
                     [](const FlankSample& a, const FlankSample& b) { return a.station_mm < b.station_mm; });
    return samples;
}

// An option that changes nothing would let its user believe that it did.
void check_options(const FitOptions& o) {
    const std::string model = "; fit.model is " + std::string(name(o.model)) + "; ";
    if (!interpolates(o.model) && o.axis != FitAxis::length) {
        throw InputError("fit: fit.axis is for models that interpolate" + model + "set fit.axis to length");
    }
    if (o.model != FitModel::parametric && o.parametrization != Objective::chord) {
        throw InputError("fit: fit.parametrization is for the parametric model" + model +
                         "set fit.model to parametric or fit.parametrization to chord");
    }
    const bool saddle = o.model == FitModel::automatic || o.model == FitModel::saddle;
    for (const auto* known : {&o.branch_radius_mm, &o.header_radius_mm, &o.angle_deg, &o.offset_mm}) {
        if (!saddle && (*known)[1] != 0) {
            throw InputError("fit: fit.branch_radius_mm, header_radius_mm, angle_deg and offset_mm are for a saddle" +
                             model + "set fit.model to auto or saddle, or these to [0, 0]");
        }
    }
}

std::optional<Measured> known(const std::vector<double>& given, const char* key, double unit = 1) {
    ensure(given.size() == 2, "a value and its sigma");
    if (given[1] == 0 && given[0] != 0) {
        throw InputError(std::string("fit: fit.") + key + " is " + shortest(given[0]) +
                         " with a sigma of 0; a sigma above 0 is needed, e.g. [" + shortest(given[0]) +
                         ", 0.1]; [0, 0] is for nothing known");
    }
    return given[1] == 0 ? std::nullopt : std::optional(Measured{unit * given[0], unit * given[1]});
}

SaddleNominals nominals_of(const FitOptions& o) {
    return {known(o.branch_radius_mm, "branch_radius_mm"), known(o.header_radius_mm, "header_radius_mm"),
            known(o.angle_deg, "angle_deg", std::numbers::pi / 180), known(o.offset_mm, "offset_mm")};
}

// Curve, freedom, model and reason. The points get their parameters on the curve. Of a saddle its normals, else those
// of the points.
Normals fit_curve(const Seam& seam, const Nodes& nodes, const FitOptions& options, const Eigen::Vector3d& middle,
                  CurvePoints& points, SeamModel& model) {
    model.model = name(options.model);
    model.reason = "fit.model asks for it";
    if (interpolates(options.model)) {
        Nodes about_middle = nodes;
        if (about_middle.line) {
            for (Eigen::Vector3d& p : about_middle.line->p) {
                p -= middle;
            }
        }
        const FittedCurve line = interpolate_nodes(points, about_middle, seam.closed, options);
        model.curve = line.curve;
        model.degrees_of_freedom = 3 * line.freedom;
        return averaged_normals(seam);
    }
    const FittedCurve smooth = smooth_points(points, seam.closed);
    if (options.model != FitModel::spline) {
        const bool asked = options.model == FitModel::saddle;
        std::variant<SaddleModel, NoSaddle> result =
            NoSaddle{"a " + std::string(name(seam.kind)) + " is no fillet round a pipe"};
        if (seam.kind == JointKind::fillet || seam.kind == JointKind::saddle) {
            result = saddle_model(seam, middle, points, nominals_of(options), asked);
        }
        if (auto* saddle = std::get_if<SaddleModel>(&result)) {
            model.kind = JointKind::saddle;
            model.model = saddle->has_offsets ? "saddle with smooth offsets" : "saddle";
            model.reason = saddle->reason;
            model.saddle = saddle->parameters;
            model.curve = std::move(saddle->curve);
            model.degrees_of_freedom = saddle->degrees_of_freedom;
            return std::move(saddle->normals);
        }
        const std::string& reason = std::get<NoSaddle>(result).reason;
        if (asked) {
            throw InputError("fit: fit.model saddle can't serve a seam of " +
                             fixed(ArcLength(smooth.curve).length(), 1) + " mm: " + reason +
                             "; set fit.model to auto or spline");
        }
        model.model = name(FitModel::spline);
        model.reason = "no saddle: " + reason;
        model.kind = seam.kind == JointKind::saddle ? JointKind::fillet : seam.kind;
    }
    model.curve = smooth.curve;
    model.degrees_of_freedom = 3 * smooth.freedom;
    model.band = band_of(smooth.sigma, ArcLength(model.curve));
    return averaged_normals(seam);
}

// Each piece by itself. None goes round a pipe as a whole.
SeamModel fit_round_corners(const Seam& seam, const Nodes& nodes, FitOptions options) {
    if (options.model == FitModel::saddle) {
        throw InputError("fit: fit.model saddle can't serve a seam with " + std::to_string(seam.corners.size()) +
                         " corners; set fit.model to auto or spline");
    }
    std::string reason = "fit.model asks for it";
    if (options.model == FitModel::automatic) {
        options = {};
        options.model = FitModel::spline;
        reason = "no saddle: the seam has corners";
    }
    const std::vector<SeamPiece> pieces = pieces_of(seam);
    const std::vector<Nodes> own =
        interpolates(options.model) ? nodes_of_pieces(seam, nodes, pieces) : std::vector<Nodes>(pieces.size());
    std::vector<SeamModel> models;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        models.push_back(fit(pieces[k].seam, own[k], options));
    }
    SeamModel model = join_pieces(seam, std::move(models));
    model.reason = reason + "; " + std::to_string(pieces.size()) + " smooth pieces that meet in " +
                   std::to_string(seam.corners.size()) + " corners";
    return model;
}

}  // namespace

Fields describe(FitOptions& o) {
    return {
        {"model", choice(o.model, kFitModelNames),
         "auto: saddle where a round pipe explains the points, else spline through all of them; the others pass nodes"},
        {"axis", choice(o.axis, kFitAxisNames), "what the nodes' x, y and z are interpolated over"},
        {"parametrization", choice(o.parametrization, kFitParametrizationNames),
         "how the parametric model spaces its parameter"},
        {"degree", &o.degree, "highest degree of newton-*, stirling, bessel and lagrange", within(1, 5)},
        {"branch_radius_mm", &o.branch_radius_mm,
         "known radius of a saddle's branch, [value, 1 sigma]; [0, 0]: unknown", at_least(0), 2},
        {"header_radius_mm", &o.header_radius_mm, "known radius of its header, [value, 1 sigma]", at_least(0), 2},
        {"angle_deg", &o.angle_deg, "known angle of the axes, or to a plate, [value, 1 sigma]", at_least(0), 2},
        {"offset_mm", &o.offset_mm, "known distance of the axes, [value, 1 sigma]", at_least(0), 2}};
}

SeamModel fit(const Seam& seam, const Nodes& nodes, const FitOptions& options) {
    check_options(options);
    if (!seam.corners.empty()) {
        return fit_round_corners(seam, nodes, options);
    }
    if (seam.points.size() < 6) {
        throw InputError("fit: the seam has " + std::to_string(seam.points.size()) +
                         " points; at least 6 are needed; lower extract.station_mm");
    }
    const Eigen::Vector3d middle = middle_of(seam);
    CurvePoints points = points_about(seam, middle);
    SeamModel model;
    model.kind = seam.kind;
    model.closed = seam.closed;
    const Normals normals = fit_curve(seam, nodes, options, middle, points, model);
    double sum = 0;
    for (std::size_t i = 0; i < points.p.size(); ++i) {
        const double r = (position(model.curve, points.u[i]) - points.p[i]).norm();
        sum += r * r;
        model.residual_max_mm = std::max(model.residual_max_mm, r);
    }
    model.residual_rms_mm = std::sqrt(sum / static_cast<double>(points.p.size()));
    for (Eigen::Vector3d& control : model.curve.control) {
        control += middle;
    }
    const ArcLength arc(model.curve);
    model.length_mm = arc.length();
    model.flanks = flank_samples(seam, arc, points.u, normals);
    return model;
}

}  // namespace seampath
