#include "tools/saddle_difference.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "stages/error.hpp"
#include "stages/fit/fit.hpp"
#include "tools/saddle_form.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

/// Places at which both seams are compared: every degree.
constexpr int kPlaces = 360;

HeaderKind header_of(SurfaceShape shape) {
    switch (shape) {
        case SurfaceShape::plane:
            return HeaderKind::plane;
        case SurfaceShape::sphere:
            return HeaderKind::sphere;
        case SurfaceShape::cylinder:
            return HeaderKind::cylinder;
        case SurfaceShape::cone:
            break;
    }
    throw InputError(
        "saddle: the fitted header is a cone, whose half angle a run does not keep; a plane, cylinder or sphere was "
        "needed; compare its seam with interpolate");
}

Vector3d square_to(const Vector3d& v, const Vector3d& tangent) {
    return v - v.dot(tangent) * tangent;
}

/// Each dimension that a drawing and a fit both have, and where it stands in SaddleDimensions.
struct Compared {
    const char* name;
    bool is_angle;
    double SaddleDimensions::*nominal;
    std::optional<Measured> fitted;
};

std::vector<Compared> compared(const SaddleParameters& f) {
    std::vector<Compared> all{{"branch_radius", false, &SaddleDimensions::branch_radius_mm, f.branch_radius_mm},
                              {"header_radius", false, &SaddleDimensions::header_radius_mm, f.header_radius_mm},
                              {"angle", true, &SaddleDimensions::angle, f.angle_rad},
                              {"offset", false, &SaddleDimensions::offset_mm, f.offset_mm}};
    std::erase_if(all, [](const Compared& c) { return !c.fitted; });
    return all;
}

/// How far the part square to travel moves with each dimension's sigma, at every place.
void add_sigmas(SaddleDifference& d, const std::vector<Compared>& dimensions, const SaddleCurve& nominal) {
    std::vector<double> square(d.places.size(), 0);
    for (const Compared& c : dimensions) {
        if (!(c.fitted->sigma > 0)) {
            continue;
        }
        SaddleDimensions low = d.fitted, high = d.fitted;
        low.*c.nominal -= c.fitted->sigma;
        high.*c.nominal += c.fitted->sigma;
        const SaddleCurve from = saddle_of(low), to = saddle_of(high);
        for (std::size_t i = 0; i < d.places.size(); ++i) {
            const double theta = d.places[i].theta;
            square[i] += square_to(0.5 * (to.at(theta).p - from.at(theta).p), nominal.at(theta).tangent).squaredNorm();
        }
    }
    for (std::size_t i = 0; i < d.places.size(); ++i) {
        d.places[i].sigma_mm = std::sqrt(square[i]);
    }
}

std::vector<double> compared_at() {
    std::vector<double> thetas;
    for (int k = 0; k < kPlaces; ++k) {
        thetas.push_back(2 * std::numbers::pi * k / kPlaces);
    }
    return thetas;
}

std::vector<Vector3d> form_of(const SeamModel& model, const SaddleCurve& saddle, const std::vector<double>& thetas) {
    return has_offsets(model) && model.closed ? form_differences(model.curve, saddle, thetas)
                                              : std::vector<Vector3d>(thetas.size(), Vector3d::Zero());
}

}  // namespace

SaddleDimensions dimensions_of(const SaddleParameters& fitted, const std::optional<SaddleDimensions>& like) {
    SaddleDimensions d;
    d.header = header_of(fitted.header);
    d.branch_radius_mm = fitted.branch_radius_mm.value;
    d.header_radius_mm = fitted.header_radius_mm ? fitted.header_radius_mm->value : 0;
    d.angle = fitted.angle_rad ? fitted.angle_rad->value : d.angle;
    d.offset_mm = fitted.offset_mm ? fitted.offset_mm->value : 0;
    constexpr double kRight = std::numbers::pi / 2;
    if (like && (like->angle - kRight) * (d.angle - kRight) < 0) {
        d.angle = std::numbers::pi - d.angle;
    }
    if (like) {
        d.offset_mm = std::copysign(d.offset_mm, like->offset_mm);
    }
    return d;
}

bool has_offsets(const SeamModel& fitted) {
    return fitted.model != name(FitModel::saddle);
}

SaddleDifference saddle_difference(std::size_t seam, const SeamModel& model, const SaddleDimensions& nominal) {
    const SaddleParameters& fitted = model.saddle.value();
    SaddleDifference d;
    d.seam = seam;
    d.nominal = nominal;
    d.fitted = dimensions_of(fitted, nominal);
    if (d.fitted.header != nominal.header) {
        throw InputError("saddle: the header of seam " + std::to_string(seam) + " was fitted as a " +
                         std::string(kHeaderNames[static_cast<std::size_t>(d.fitted.header)]) +
                         ", the nominal one is a " +
                         std::string(kHeaderNames[static_cast<std::size_t>(nominal.header)]) +
                         "; headers of one shape were needed; give --header and its sizes as fitted");
    }
    const std::vector<Compared> dimensions = compared(fitted);
    for (const Compared& c : dimensions) {
        d.dimensions.push_back({c.name, c.is_angle, {d.fitted.*c.nominal, c.fitted->sigma}, nominal.*c.nominal});
    }
    const SaddleCurve is = saddle_of(d.fitted), should = saddle_of(nominal);
    d.fitted_length_mm = is.length();
    d.nominal_length_mm = should.length();
    const std::vector<double> thetas = compared_at();
    const std::vector<Vector3d> form = form_of(model, is, thetas);
    double sum = 0;
    for (std::size_t k = 0; k < thetas.size(); ++k) {
        PlaceDifference place;
        place.theta = thetas[k];
        const SaddlePoint at = should.at(place.theta), there = is.at(place.theta);
        place.station_mm = should.station(place.theta);
        place.nominal = at.p;
        place.difference = there.p + form[k] - at.p;
        place.form_mm = form[k].norm();
        place.branch_wall_mm = place.difference.dot(at.n1);
        place.header_wall_mm = place.difference.dot(at.n2);
        place.distance_mm = square_to(place.difference, at.tangent).norm();
        place.opening = there.opening - at.opening;
        sum += place.distance_mm * place.distance_mm;
        d.places.push_back(place);
    }
    add_sigmas(d, dimensions, should);
    d.rms_mm = std::sqrt(sum / kPlaces);
    d.worst = *std::max_element(d.places.begin(), d.places.end(),
                                [](const auto& a, const auto& b) { return a.distance_mm < b.distance_mm; });
    return d;
}

}  // namespace seampath
