#include "stages/extract/extract.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "stages/error.hpp"
#include "stages/extract/around.hpp"
#include "stages/extract/borders.hpp"
#include "stages/extract/butts.hpp"
#include "stages/extract/creases.hpp"
#include "stages/extract/folds.hpp"
#include "stages/extract/grooves.hpp"
#include "stages/extract/laps.hpp"
#include "stages/extract/seam_corners.hpp"
#include "stages/extract/slanted.hpp"
#include "stages/extract/surfels.hpp"
#include "stages/geometry/bulk.hpp"
#include "stages/geometry/views.hpp"

namespace seampath {
namespace {

using namespace detail;

constexpr std::size_t kLeastScanPoints = 200;

// In which ends of seams meet, in distances that points of seams have unless asked for otherwise: each ends within one
// of them before a corner.
constexpr double kCornerReach = 1.5;

// Distance of the points of a seam: as fine as the scan's points allow.
double station_distance(const ScanScale& scale, std::size_t points) {
    constexpr double kCells = 60000;
    const double widths = std::clamp(std::sqrt(static_cast<double>(points) / kCells), 2.5, 4.0);
    return std::max(widths * scale.spacing, 2 * scale.noise);
}

// Cells as fine as that, so that narrow faces are seen; coarser where a large scan would make too many of them: beyond
// kMany points, one half of what more points add makes cells finer, and the other half fills them.
double cell_size(const ScanScale& scale, std::size_t points) {
    constexpr double kMany = 1.5e6;
    return station_distance(scale, points) * std::max(1.0, std::pow(static_cast<double>(points) / kMany, 0.25));
}

// Where nothing told the air from the material of a piece, its joints do: a scan made to find a seam shows more of the
// joints that are asked for than of other edges. Who asks for convex ones knows better than an assumption, too. Returns
// whether one was given up.
bool tell_sides(std::vector<Crease>& creases, bool joints_are_convex) {
    std::map<std::uint32_t, double> balance;
    for (const Crease& c : creases) {
        balance[c.piece] += c.concave != joints_are_convex ? c.weight : -c.weight;
    }
    bool given_up = false;
    for (Crease& c : creases) {
        const bool open = c.side == AirSide::unknown || (c.side == AirSide::assumed && joints_are_convex);
        if (open && balance[c.piece] < 0) {
            c.concave = !c.concave;
            c.n1 = -c.n1;
            c.n2 = -c.n2;
            given_up = given_up || c.side == AirSide::assumed;
        }
    }
    return given_up;
}

bool asked(const ExtractOptions& options, JointChoice kind) {
    return options.joint == kind || options.joint == JointChoice::automatic;
}

bool asks_for_corners(const ExtractOptions& options) {
    return options.joint == JointChoice::corner || (options.joint == JointChoice::automatic && options.convex);
}

void take(Extraction& result, std::vector<Seam> seams, std::vector<std::string> remarks) {
    std::move(seams.begin(), seams.end(), std::back_inserter(result.seams));
    std::move(remarks.begin(), remarks.end(), std::back_inserter(result.remarks));
}

// Without the creases that a joint has claimed.
void leave_out(std::vector<Crease>& creases, const std::vector<char>& claimed) {
    std::size_t i = 0;
    std::erase_if(creases, [&](const Crease&) { return claimed[i++] != 0; });
}

// Whether the seam runs beside a butt joint or groove, within what lies between their plates.
bool beside_groove(const Seam& seam, const std::vector<Seam>& found, double spacing) {
    const auto known = [](const Measured& m) { return std::isnan(m.value) ? 0 : std::abs(m.value); };
    std::size_t beside = 0;
    for (const SeamPoint& point : seam.points) {
        beside += std::any_of(found.begin(), found.end(), [&](const Seam& other) {
            for (std::size_t i = 0; i < other.groove.size(); ++i) {
                const GrooveStation& g = other.groove[i];
                const double reach = known(g.gap_mm) + known(g.mismatch_mm) + known(g.depth_mm) + 3 * spacing;
                if ((other.points[i].p - point.p).norm() < reach) {
                    return true;
                }
            }
            return false;
        });
    }
    return 2 * beside > seam.points.size();
}

// The top edges of a groove are no butt joint, and a plate that stands higher than the other is no lap on it.
void leave_out_beside_grooves(std::vector<Seam>& seams, const std::vector<Seam>& found, double spacing) {
    std::erase_if(seams, [&](const Seam& seam) { return beside_groove(seam, found, spacing); });
}

// What is seen between the plates of a butt joint, a wall and the strays before it, is no fillet.
void leave_out_in_gaps(std::vector<Seam>& folds, const std::vector<Seam>& found, double spacing) {
    std::vector<Seam> butts;
    std::copy_if(found.begin(), found.end(), std::back_inserter(butts),
                 [](const Seam& seam) { return seam.kind == JointKind::butt; });
    std::erase_if(
        folds, [&](const Seam& seam) { return seam.kind != JointKind::corner && beside_groove(seam, butts, spacing); });
}

// What looks like a gap is none where a web stands in it, that has a fillet with either side: one plate goes on below.
void leave_out_bridged(std::vector<Seam>& seams, const std::vector<Seam>& folds, double spacing) {
    const auto has_fold = [&](const SeamPoint& point, double reach, const Eigen::Vector3d& to) {
        return std::any_of(folds.begin(), folds.end(), [&](const Seam& fold) {
            return fold.kind != JointKind::corner &&
                   std::any_of(fold.points.begin(), fold.points.end(), [&](const SeamPoint& p) {
                       const Eigen::Vector3d d = p.p - point.p;
                       return d.norm() < reach && d.dot(to) > 0;
                   });
        });
    };
    std::erase_if(seams, [&](const Seam& seam) {
        if (seam.kind != JointKind::butt || seam.points.size() < 2) {
            return false;
        }
        std::size_t bridged = 0;
        for (std::size_t i = 0; i < seam.points.size(); ++i) {
            const SeamPoint& point = seam.points[i];
            const SeamPoint& next = seam.points[i + 1 < seam.points.size() ? i + 1 : i - 1];
            const Eigen::Vector3d across = (next.p - point.p).cross(point.n1 + point.n2);
            const double reach = 0.5 * seam.groove[i].gap_mm.value + 3 * spacing;
            bridged += has_fold(point, reach, across) && has_fold(point, reach, -across);
        }
        return 2 * bridged > seam.points.size();
    });
}

// Each kind of joint in turn: what one explains is not offered to the next. `creases` are those of `around`.
void find_joints(Extraction& result, const Around& around, std::vector<Crease>& creases,
                 const ExtractOptions& options) {
    if (asked(options, JointChoice::v_groove)) {
        Grooves grooves = find_grooves(around, options.min_length_mm);
        result.registration_mm = grooves.registration_mm;
        leave_out(creases, grooves.claimed);
        take(result, std::move(grooves.seams), std::move(grooves.remarks));
    }
    const bool butt = asked(options, JointChoice::butt), lap = asked(options, JointChoice::lap);
    const std::vector<Border> borders = butt || lap ? find_borders(around) : std::vector<Border>{};
    if (butt) {
        Butts butts = find_butts(around, borders, options.min_length_mm);
        leave_out_beside_grooves(butts.seams, result.seams, around.field.overall.spacing);
        take(result, std::move(butts.seams), std::move(butts.remarks));
    }
    std::vector<Track> of_laps;
    if (lap) {
        Laps laps =
            find_laps(around, borders, {options.max_step_mm, options.joint == JointChoice::lap, options.min_length_mm});
        result.registration_mm = std::max(result.registration_mm, laps.registration_mm);
        of_laps = std::move(laps.tracks);
        leave_out_beside_grooves(laps.seams, result.seams, around.field.overall.spacing);
        take(result, std::move(laps.seams), std::move(laps.remarks));
    }
    const bool fillet = asked(options, JointChoice::fillet);
    Folds folds =
        find_folds(around, fillet || options.joint == JointChoice::saddle, asks_for_corners(options), options, of_laps);
    result.registration_mm = std::max(result.registration_mm, folds.registration_mm);
    if (options.joint == JointChoice::saddle) {
        std::erase_if(folds.seams, [](const Seam& seam) { return seam.kind != JointKind::saddle; });
    }
    leave_out_bridged(result.seams, folds.seams, around.field.overall.spacing);
    leave_out_in_gaps(folds.seams, result.seams, around.field.overall.spacing);
    take(result, std::move(folds.seams), std::move(folds.remarks));
    if (fillet) {
        take(result, find_slanted_fillets(around, result.seams, options.min_length_mm), {});
    }
}

void contradict(Extraction& result, JointChoice asked_for, const std::vector<Seam>& seen) {
    for (const Seam& seam : seen) {
        result.remarks.push_back("extract.joint says " +
                                 std::string(kJointChoiceNames[static_cast<std::size_t>(asked_for)]) +
                                 ", but the scan shows a " + std::string(name(seam.kind)) + ": " + seam.kind_reason);
    }
}

// Where fillets were asked for, the parts of other joints look like some.
void tell_what_fillets_belong_to(Extraction& result, const Around& around, const ExtractOptions& options) {
    contradict(result, options.joint, find_grooves(around, options.min_length_mm).seams);
    contradict(result, options.joint,
               find_laps(around, find_borders(around), {options.max_step_mm, false, options.min_length_mm}).seams);
}

}  // namespace

Fields describe(ExtractOptions& o) {
    return {
        {"joint", choice(o.joint, kJointChoiceNames),
         "joint kind to look for; auto: by what is seen, each seam with a confidence and a reason"},
        {"convex", &o.convex, "auto also reports convex edges, as corner joints: every block has some"},
        {"max_thickness_mm", &o.max_thickness_mm,
         "a convex edge with a face no wider than this is a plate's rim, no corner joint; 0: a third of the other "
         "face, "
         "a quarter where the plate's other rims are narrower",
         at_least(0)},
        {"max_step_mm", &o.max_step_mm,
         "highest step between parallel faces that is taken for machined; a higher one whose upper plate is three "
         "times "
         "as wide as thick, on a part that shows a side of its own, is a lap",
         at_least(0)},
        {"join_at_corners", &o.join_at_corners,
         "fillets that go on round a corner are one seam with corners; otherwise one seam a side"},
        {"min_length_mm", &o.min_length_mm, "shortest seam that is reported; 0 takes it from the scan", at_least(0)},
        {"station_mm", &o.station_mm, "distance of the extracted points; 0 takes it from the scan", at_least(0)}};
}

Extraction extract(const Scan& scan, const ExtractOptions& options) {
    if (scan.points.size() < kLeastScanPoints) {
        throw InputError("extract: the scan has " + std::to_string(scan.points.size()) + " points; at least " +
                         std::to_string(kLeastScanPoints) +
                         " are needed to fit two surfaces; scan the part with a finer pitch");
    }
    Extraction result;
    const ScaleField field = estimate_scale(scan.points);
    const ScanScale& scale = field.overall;
    result.spacing_mm = scale.spacing;
    result.noise_mm = scale.noise;
    if (scale.spacing <= 0) {
        throw InputError("extract: all points lie in one place; a part with surfaces was needed; check the file");
    }
    const PointGrid grid(scan.points, cell_size(scale, scan.points.size()), without_strays(scan.points));
    Surfels surfels = make_surfels(grid, 4.5 * grid.cell());
    orient(surfels, grid, scan);
    result.orientation_reason = surfels.orientation_reason;
    std::vector<Crease> creases = find_creases(surfels, field);
    if (tell_sides(creases, options.joint == JointChoice::corner)) {
        result.orientation_reason = "air side is the one to which most edges are convex, since corners were asked for";
    }

    // An organised cloud is one view.
    const std::vector<std::size_t> views = scan.pixel.empty() ? view_starts(scan.points) : std::vector<std::size_t>{0};
    result.views = static_cast<int>(views.size());
    const Tracker following{grid, field, views, following_window,
                            options.station_mm > 0 ? options.station_mm : station_distance(scale, scan.points.size())};
    const Around around{scan, grid, field, surfels, creases, following};

    find_joints(result, around, creases, options);
    if (options.joint == JointChoice::fillet) {
        tell_what_fillets_belong_to(result, around, options);
    } else if (options.joint != JointChoice::automatic && result.seams.empty()) {
        ExtractOptions automatic = options;
        automatic.joint = JointChoice::automatic;
        contradict(result, options.joint, extract(scan, automatic).seams);
    }
    if (options.join_at_corners) {
        join_at_corners(result.seams, kCornerReach * station_distance(scale, scan.points.size()));
    }
    std::stable_sort(result.seams.begin(), result.seams.end(),
                     [](const Seam& a, const Seam& b) { return a.points.size() > b.points.size(); });
    return result;
}

}  // namespace seampath
