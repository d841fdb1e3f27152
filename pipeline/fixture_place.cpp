#include "pipeline/fixture_place.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include <Eigen/Dense>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSecondsPerHour = 3600;

double largest_sigma(const Eigen::MatrixXd& covariance) {
    return std::sqrt(
        std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance).eigenvalues().maxCoeff()));
}

double age_h(const StoredFixture& fixture, const std::string& file, double now_s) {
    std::tm time{};
    const char* end = strptime(fixture.date.c_str(), "%Y-%m-%dT%H:%M:%SZ", &time);
    if (!end || *end != '\0') {
        throw InputError("plan.fixture: " + file + ": \"" + fixture.date +
                         "\" is no date; one like 2026-11-26T05:00:00Z (UTC) was needed; calibrate again");
    }
    return (now_s - static_cast<double>(timegm(&time))) / kSecondsPerHour;
}

void check_age(const StoredFixture& fixture, const Config& config, double now_s) {
    if (!config.plan.fixture_max_age_h) {
        return;
    }
    const double age = age_h(fixture, config.plan.fixture, now_s);
    if (age > *config.plan.fixture_max_age_h || age < 0) {
        throw InputError("plan.fixture: " + config.plan.fixture + ": the calibration of " + fixture.date + " is " +
                         (age < 0 ? fixed(-age, 1) + " h ahead of this machine's clock" : fixed(age, 1) + " h old") +
                         "; at most " + shortest(*config.plan.fixture_max_age_h) +
                         " h were allowed (plan.fixture_max_age_h); calibrate again");
    }
}

}  // namespace

std::optional<StoredFixture> put_in_place(Config& config, double now_s) {
    if (config.plan.fixture.empty()) {
        return std::nullopt;
    }
    if (config.export_.base_from_scan != ExportOptions().base_from_scan) {
        throw InputError("plan.fixture: " + config.plan.fixture +
                         " and export.base_from_scan both say where the scan stands; leave one of them out");
    }
    const StoredFixture fixture = read_fixture_result(config.plan.fixture);
    if (!fixture.pass) {
        throw InputError("plan.fixture: " + config.plan.fixture + ": the calibration of \"" + fixture.name + "\" of " +
                         fixture.date + " did not pass; one that passed was needed; calibrate again");
    }
    check_age(fixture, config, now_s);
    const Vector3d p = fixture.base_from_part.translation();
    const Eigen::Quaterniond q = Eigen::Quaterniond(fixture.base_from_part.linear()).normalized();
    config.export_.base_from_scan = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
    config.export_.base_from_scan_sigma_mm = largest_sigma(fixture.covariance.topLeftCorner<3, 3>());
    config.export_.base_from_scan_sigma_deg = largest_sigma(fixture.covariance.bottomRightCorner<3, 3>()) / kDegree;
    return fixture;
}

void add_place_sigma(const StoredFixture& fixture, Plan& plan) {
    const Eigen::Isometry3d& T = fixture.base_from_part;
    for (Waypoint& w : plan.waypoints) {
        const Matrix3d tool = w.q.toRotationMatrix();
        const Matrix3d in_part = T.linear().transpose() * covariance_at(fixture.covariance, T, w.p) * T.linear();
        const Eigen::Matrix<double, 3, 2> square = tool.rightCols<2>();  // travel is along the tool's X
        w.sigma_mm = std::hypot(w.sigma_mm, largest_sigma(square.transpose() * in_part * square));
    }
}

std::string place_key(const StoredFixture& fixture) {
    std::string key = fixture.name;
    const auto add = [&](double number) { key += "\n" + shortest(number); };
    std::for_each(fixture.base_from_part.matrix().reshaped().begin(), fixture.base_from_part.matrix().reshaped().end(),
                  add);
    std::for_each(fixture.covariance.reshaped().begin(), fixture.covariance.reshaped().end(), add);
    return key;
}

}  // namespace seampath
