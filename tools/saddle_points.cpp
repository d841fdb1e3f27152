#include "tools/saddle_points.hpp"

#include <cmath>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"
#include "tools/choice.hpp"

namespace seampath {
namespace {

constexpr double kMostSteps = 1e7;

}  // namespace

SaddleSteps saddle_steps(const SaddleCurve& curve, const SaddleStepOptions& given, double speed_mm_s) {
    SaddleSteps i;
    i.law = static_cast<StepLaw>(choice("--step", given.step, kStepLawNames));
    i.pose = static_cast<PoseLaw>(choice("--pose", given.pose, kPoseLawNames));
    if (!(given.pose_angle_deg > 0 && given.pose_angle_deg < 180)) {
        throw InputError("--pose-angle-deg: " + shortest(given.pose_angle_deg) +
                         " deg points into the branch's wall; an angle between 0 and 180 deg is needed");
    }
    i.initial = given.pose_angle_deg * kDegree;
    i.speed_mm_s = speed_mm_s;
    if (given.period_s && !(*given.period_s > 0 && std::isfinite(*given.period_s))) {
        throw InputError("--period-s: " + shortest(*given.period_s) + " is no period; a time above 0 is needed");
    }
    if (given.steps < 1) {
        throw InputError("--steps: " + std::to_string(given.steps) + " is too few; at least 1 is needed");
    }
    i.step_mm = given.period_s ? speed_mm_s * *given.period_s : curve.length() / given.steps;
    if (curve.length() / i.step_mm > kMostSteps) {
        throw InputError("--period-s: steps of " + shortest(i.step_mm) +
                         " mm are more than 10 million round this seam; a longer period is needed");
    }
    i.angles = step_angles(curve, i.law, i.step_mm);
    return i;
}

std::string saddle_points_csv(const SaddleCurve& curve, const SaddleSteps& i) {
    std::string text =
        "# frame: nominal (right-handed)\n"
        "# unit: mm, s, deg; theta: branch angle; torch: its angle from the branch's wall, square to travel\n"
        "index,theta_deg,station_mm,time_s,x,y,z,torch_deg,opening_deg,curvature_per_mm,tx,ty,tz,n1x,n1y,n1z,n2x,n2y,"
        "n2z\n";
    double time_s = 0, before_mm = 0;
    for (std::size_t k = 0; k < i.angles.size(); ++k) {
        const SaddlePoint s = curve.at(i.angles[k]);
        const double station_mm = curve.station(i.angles[k]);
        // Every step takes one period, but for what is left over at the end.
        const bool last = k + 1 == i.angles.size();
        time_s =
            last ? time_s + (station_mm - before_mm) / i.speed_mm_s : static_cast<double>(k) * i.step_mm / i.speed_mm_s;
        before_mm = station_mm;
        text += std::to_string(k);
        for (const double value :
             {s.theta / kDegree, station_mm, time_s, s.p.x(), s.p.y(), s.p.z(),
              torch_angle(s, i.pose, i.initial) / kDegree, s.opening / kDegree, s.curvature_per_mm, s.tangent.x(),
              s.tangent.y(), s.tangent.z(), s.n1.x(), s.n1.y(), s.n1.z(), s.n2.x(), s.n2.y(), s.n2.z()}) {
            text += ',' + shortest(value);
        }
        text += '\n';
    }
    return text;
}

}  // namespace seampath
