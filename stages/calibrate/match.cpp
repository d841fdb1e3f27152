#include <algorithm>
#include <cmath>

#include "stages/calibrate/calibrate.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Assignment = std::vector<std::optional<std::size_t>>;

// So many of each are told apart within a second; a scan that shows more balls shows something else.
constexpr std::size_t kMostBalls = 64;
constexpr std::size_t kMostAssignments = 20000;

// Depth first over the nominal balls: each takes a found one whose distances to those already taken agree, or none.
class Search {
public:
    Search(const std::vector<NamedPoint>& nominal, const std::vector<Vector3d>& found, double tolerance)
        : nominal_(nominal), found_(found), tolerance_(tolerance), current_(nominal.size()) {
        descend(0, 0);
    }
    std::size_t most = 0;          // balls assigned
    std::vector<Assignment> best;  // all assignments of so many

private:
    bool agrees(std::size_t i, std::size_t k) const {
        for (std::size_t j = 0; j < i; ++j) {
            if (!current_[j]) {
                continue;
            }
            const double nominal = (nominal_[i].p - nominal_[j].p).norm();
            if (*current_[j] == k || std::abs((found_[k] - found_[*current_[j]]).norm() - nominal) > tolerance_) {
                return false;
            }
        }
        return true;
    }

    void descend(std::size_t i, std::size_t taken) {
        if (taken + (nominal_.size() - i) < std::max<std::size_t>(most, 3) || best.size() > kMostAssignments) {
            return;
        }
        if (i == nominal_.size()) {
            if (taken > most) {
                best.clear();
            }
            most = taken;
            best.push_back(current_);
            return;
        }
        for (std::size_t k = 0; k < found_.size(); ++k) {
            if (agrees(i, k)) {
                current_[i] = k;
                descend(i + 1, taken + 1);
            }
        }
        current_[i].reset();
        descend(i + 1, taken);
    }

    const std::vector<NamedPoint>& nominal_;
    const std::vector<Vector3d>& found_;
    double tolerance_;
    Assignment current_;
};

// Root of the mean square distance after the best rigid motion.
double misfit(const std::vector<NamedPoint>& nominal, const std::vector<Vector3d>& found,
              const Assignment& assignment) {
    std::vector<Vector3d> a, b;
    for (std::size_t i = 0; i < nominal.size(); ++i) {
        if (assignment[i]) {
            a.push_back(nominal[i].p);
            b.push_back(found[*assignment[i]]);
        }
    }
    const Eigen::Isometry3d T = rigid_through(a, b);
    double squares = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        squares += (T * a[i] - b[i]).squaredNorm() / static_cast<double>(a.size());
    }
    return std::sqrt(squares);
}

std::string names(const std::vector<NamedPoint>& nominal, const Assignment& a, const Assignment& b) {
    std::string text;
    for (std::size_t i = 0; i < nominal.size(); ++i) {
        if (a[i] != b[i]) {
            text += (text.empty() ? "" : ", ") + nominal[i].name;
        }
    }
    return text;
}

}  // namespace

std::vector<std::optional<std::size_t>> match_balls(const std::vector<NamedPoint>& nominal,
                                                    const std::vector<Vector3d>& found, double tolerance_mm) {
    if (nominal.size() > kMostBalls || found.size() > kMostBalls) {
        throw InputError("calibrate: " + std::to_string(nominal.size()) + " nominal and " +
                         std::to_string(found.size()) + " found balls; at most 64 of each can be told apart");
    }
    const Search search(nominal, found, tolerance_mm);
    if (search.most < 3) {
        throw InputError("calibrate: " + std::to_string(found.size()) +
                         " balls were found, and no three of them lie as far apart as nominal ones, within " +
                         shortest(tolerance_mm) +
                         " mm; three were needed; check the nominal file, its unit, and the balls' diameter");
    }
    std::vector<Assignment> proper;
    for (const Assignment& assignment : search.best) {
        if (misfit(nominal, found, assignment) <= tolerance_mm) {
            proper.push_back(assignment);
        }
    }
    if (proper.empty()) {
        throw InputError(
            "calibrate: the balls lie as the mirror image of the nominal ones; check the signs of the nominal places, "
            "or for a left-handed frame");
    }
    if (proper.size() > 1) {
        throw InputError("calibrate: the balls can be told apart in " + std::to_string(proper.size()) +
                         " ways within " + shortest(tolerance_mm) + " mm: " + names(nominal, proper[0], proper[1]) +
                         " can change places; distances that differ by more were needed; move a ball, or lower "
                         "match_tolerance_mm");
    }
    return proper.front();
}

}  // namespace seampath
