#include "stages/plan/weld.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/air.hpp"
#include "stages/plan/aside.hpp"
#include "stages/plan/passes.hpp"
#include "stages/plan/stations.hpp"
#include "stages/plan/stretch.hpp"
#include "stages/plan/text.hpp"
#include "stages/plan/weave.hpp"

namespace seampath::planning {
namespace {

using Eigen::Vector3d;

// Places at which the travel along a weld is told.
constexpr int kTravelSamples = 200;

// A pose nearer to another, along the seam, is the same.
constexpr double kSamePlace_mm = 1e-6;

// A closed seam's last pose that is turned by less from the first is that one.
constexpr double kSamePose = 1e-6;

Waypoint weld_waypoint(const TorchPath& path, const TorchPose& pose, double speed_mm_s, double time_s) {
    Waypoint w;
    w.seam = path.seam();
    w.kind = WaypointKind::weld;
    w.station_mm = path.before_mm() + pose.station_mm;
    w.p = pose.p;
    w.q = pose.q;
    w.speed_mm_s = speed_mm_s;
    w.time_s = time_s;
    w.sigma_mm = pose.sigma_mm;
    return w;
}

void refuse_short(const TorchPath& path, const std::string& what, double needed_mm, const std::string& remedy) {
    if (path.arc().length() <= needed_mm) {
        throw InputError(seam_text(path.seam()) + " is welded over " + number(path.arc().length()) +
                         " mm at a time, no more than " + what + " of " + number(needed_mm) + " mm; " + remedy);
    }
}

/// One weld in the making.
class Weld {
public:
    Weld(const TorchPath& path, const PlanOptions& options, SeamWelds& result)
        : path_(path),
          o_(options),
          result_(result),
          samples_(sample(path, options.chord_tolerance_mm)),
          profile_(path, samples_, options) {}

    std::vector<Waypoint> make() {
        WeldPoses weld = weld_poses(path_, samples_, profile_, o_);
        if (o_.weave != WeaveShape::none) {
            swing(weld);
        } else {
            add_all(weld.poses);
        }
        result_.max_chord_error_mm = std::max(result_.max_chord_error_mm, weld.max_chord_error_mm);
        points_.front().kind = WaypointKind::weld_start;
        go_back(weld.poses);
        points_.back().kind = WaypointKind::weld_end;
        add_leads();
        return std::move(points_);
    }

    void tell_travel() {
        const int index = static_cast<int>(result_.welds.size());
        const double length = path_.arc().length();
        std::vector<double> stations = profile_.telling();
        for (int k = 0; k <= kTravelSamples; ++k) {
            stations.push_back(k == kTravelSamples ? length : length * k / kTravelSamples);
        }
        std::sort(stations.begin(), stations.end());
        std::optional<TorchPose> before;
        for (const double station : stations) {
            if (before && station - before->station_mm < kSamePlace_mm) {
                continue;
            }
            const TorchPose pose = path_.at_station(station);
            const double v = profile_.speed(pose.station_mm), way = before ? pose.station_mm - before->station_mm : 0;
            const Lean lean = path_.lean(pose);
            result_.travel.push_back(
                {path_.seam(), index, path_.before_mm() + pose.station_mm, v, profile_.acceleration(pose.station_mm),
                 v * v * curvature(path_.arc().curve(), pose.u),
                 way > 0 ? v * rotation_angle(before->q, pose.q) / way : 0, lean.work, lean.travel});
            before = pose;
        }
    }

private:
    void add_all(const std::vector<TorchPose>& poses) {
        for (const TorchPose& pose : poses) {
            const double from = points_.empty() ? 0 : points_.back().station_mm - path_.before_mm();
            const double speed = points_.empty() ? o_.air_speed_mm_s : profile_.move_speed(from, pose.station_mm);
            points_.push_back(weld_waypoint(path_, pose, speed, profile_.time(pose.station_mm)));
            if (points_.size() > 1) {
                const double chord = (pose.p - points_[points_.size() - 2].p).norm();
                result_.max_speed_error =
                    std::max(result_.max_speed_error, std::abs(1 - chord / (pose.station_mm - from)));
            }
        }
        if (path_.model().closed) {
            points_.back().p = points_.front().p;
            if (rotation_angle(points_.back().q, points_.front().q) < kSamePose) {
                points_.back().q = points_.front().q;
            }
        }
    }

    // The wire's own places are added to the poses; the speed to each is the wire's own.
    void swing(WeldPoses& weld) {
        const Weave weave(path_, o_);
        for (const double station : weave.stations()) {
            weld.poses.push_back(path_.at_station(std::min(station, path_.arc().length())));
        }
        const auto earlier = [](const TorchPose& a, const TorchPose& b) { return a.station_mm < b.station_mm; };
        const auto same = [](const TorchPose& a, const TorchPose& b) {
            return b.station_mm - a.station_mm < kSamePlace_mm;
        };
        std::stable_sort(weld.poses.begin(), weld.poses.end(), earlier);
        weld.poses.erase(std::unique(weld.poses.begin(), weld.poses.end(), same), weld.poses.end());
        add_all(weld.poses);
        for (std::size_t k = 0; k < weld.poses.size(); ++k) {
            const TorchPose& pose = weld.poses[k];
            points_[k].p += path_.middle(pose.u, pose.station_mm) * weave.offset(path_, pose);
            const double time = k > 0 ? points_[k].time_s - points_[k - 1].time_s : 0;
            if (time > 0) {
                points_[k].speed_mm_s = (points_[k].p - points_[k - 1].p).norm() / time;
            }
        }
        weld.max_chord_error_mm += weave.error_mm();
    }

    void go_back(const std::vector<TorchPose>& poses) {
        if (o_.crater_back_mm == 0) {
            return;
        }
        refuse_short(path_, "its way back", o_.crater_back_mm, "a shorter plan.crater_back_mm is needed");
        const double target = path_.arc().length() - o_.crater_back_mm;
        std::vector<TorchPose> back{path_.at_station(target)};
        std::copy_if(poses.begin(), poses.end() - 1, std::back_inserter(back),
                     [&](const TorchPose& pose) { return pose.station_mm > target + kSamePlace_mm; });
        double from = path_.arc().length();
        for (; !back.empty(); back.pop_back()) {
            const TorchPose& pose = back.back();
            const double time = points_.back().time_s + (from - pose.station_mm) / o_.speed_mm_s;
            points_.push_back(weld_waypoint(path_, pose, o_.speed_mm_s, time));
            from = pose.station_mm;
        }
    }

    void add_leads() {
        const bool ramps = o_.run_in == RunIn::before;
        const auto ramp = [&](double station) {
            return Ramp(ramps ? profile_.speed(station) : 0, o_.acceleration_mm_s2, o_.jerk_mm_s3);
        };
        const Ramp in = ramp(0), out = ramp(path_.arc().length());
        const double lead_in = std::max(o_.lead_in_mm, in.length()), lead_out = std::max(o_.lead_out_mm, out.length());
        if (lead_in + lead_out == 0) {
            return;
        }
        refuse_short(path_, "its lead-in and lead-out", lead_in + lead_out,
                     "shorter leads or a longer weld are needed");
        // On its ramp the torch is slower, and in time where the ramp says.
        const auto lead_time = [&](const Ramp& r, double way) {
            return r.duration() + (way - r.length()) / o_.speed_mm_s;
        };
        if (lead_in > 0) {
            const Vector3d along = tangent(path_.arc().curve(), path_.first());
            Waypoint begin = points_.front();
            begin.kind = WaypointKind::approach;
            begin.p -= lead_in * along;
            points_.front().speed_mm_s = o_.speed_mm_s;
            for (Waypoint& w : points_) {
                w.time_s += lead_time(in, lead_in);
            }
            points_.insert(points_.begin(), begin);
        }
        if (lead_out > 0) {
            Waypoint end = points_.back();
            end.kind = WaypointKind::retract;
            end.p += lead_out * tangent(path_.arc().curve(), path_.last());
            end.speed_mm_s = o_.speed_mm_s;
            end.time_s += lead_time(out, lead_out);
            points_.push_back(end);
        }
    }

    const TorchPath& path_;
    const PlanOptions& o_;
    SeamWelds& result_;
    Samples samples_;
    SpeedProfile profile_;
    std::vector<Waypoint> points_;
};

SeamRefusal refusal_at(const Waypoint& w, double depth_mm, const std::string& what) {
    return {w.seam, w.station_mm, depth_mm,
            seam_text(w.seam) + " is refused: at station " + number(w.station_mm) + " mm " + what};
}

// Approach before and retract behind; a refusal where the torch would touch the scan at any waypoint or on those ways.
std::optional<SeamRefusal> finish(std::vector<Waypoint>& weld, const PlanOptions& o, const Clearance* clearance) {
    for (const Waypoint& w : weld) {
        const double depth = clearance != nullptr ? clearance->depth(w.p, w.q) : 0;
        if (depth > 0) {
            return refusal_at(w, depth,
                              "the scan reaches " + number(depth) +
                                  " mm into the torch with its clearance; more room is needed, or a slimmer torch");
        }
    }
    const auto approach = backed_off(weld.front(), WaypointKind::approach, o.approach_mm, o.air_speed_mm_s, clearance);
    const auto retract = backed_off(weld.back(), WaypointKind::retract, o.retract_mm, o.air_speed_mm_s, clearance);
    if (!approach || !retract) {
        return refusal_at(!approach ? weld.front() : weld.back(), 0,
                          std::string("no straight ") + (!approach ? "approach" : "retract") +
                              " leaves the torch clear of the scan; a shorter plan.approach_mm and plan.retract_mm, or "
                              "more room, are needed");
    }
    weld.insert(weld.begin(), *approach);
    weld.push_back(*retract);
    return std::nullopt;
}

void add_welds(const SeamModel& way, int seam, const PlanOptions& options, const Clearance* clearance,
               SeamWelds& result) {
    for (const Stretch& stretch : stretches(way, seam, options)) {
        TorchPath path(stretch.model, seam, options, stretch.before_mm);
        if (clearance != nullptr) {
            result.refused = hold_clear(path, *clearance, options);
        }
        if (result.refused) {
            return;
        }
        Weld weld(path, options, result);
        std::vector<Waypoint> points = weld.make();
        result.refused = finish(points, options, clearance);
        if (result.refused) {
            return;
        }
        weld.tell_travel();
        result.welds.push_back(std::move(points));
    }
}

}  // namespace

SeamWelds welds_of(const SeamModel& model, int seam, const PlanOptions& options, const Clearance* clearance) {
    SeamWelds result;
    const SeamModel way = whole_way(model, seam, options);
    if (options.groove == GrooveForm::none) {
        add_welds(way, seam, options, clearance, result);
    } else if (!model.corners_mm.empty()) {
        throw InputError(seam_text(seam) + " has " + std::to_string(model.corners_mm.size()) +
                         " corners, and plan.groove asks for several passes, which need a smooth seam; set "
                         "extract.join_at_corners to false");
    } else {
        for (const Pass& pass : passes_of(way, seam, options)) {
            add_welds(pass.model, seam, options, clearance, result);
            if (result.refused) {
                break;
            }
            result.passes.push_back(pass.facts);
        }
    }
    if (result.refused) {
        return {{}, {}, {}, 0, 0, result.refused};
    }
    return result;
}

}  // namespace seampath::planning
