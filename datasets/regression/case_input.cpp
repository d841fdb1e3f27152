#include "datasets/regression/case_input.hpp"

#include <nlohmann/json.hpp>

#include "datasets/dataset.hpp"
#include "datasets/depth_picture.hpp"
#include "datasets/fixtures/fixture_scenes.hpp"
#include "datasets/stripe_sequence.hpp"
#include "pipeline/files.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double mm_per_unit(Unit unit) {
    return unit == Unit::m ? 1000 : unit == Unit::inch ? 25.4 : 1;
}

MadeInput make_scan(const SuiteCase& entry, std::uint64_t seed, const fs::path& folder) {
    const Dataset dataset = make_dataset(entry.scene, entry.scanner, seed);
    MadeInput input;
    input.file = write_dataset(dataset, folder, mm_per_unit(entry.unit));
    input.truth = dataset.truth;
    input.scene = dataset.scene;
    return input;
}

MadeInput make_stripes(const SuiteCase& entry, std::uint64_t seed, const fs::path& folder) {
    StripeRig rig;
    rig.images = 60;  // 0.8 mm apart
    rig.step_mm = 0.8;
    const StripeSequence sequence = make_stripe_sequence(entry.scene, rig, {}, seed, 0);
    MadeInput input;
    input.file = write_stripe_sequence(sequence, folder);
    input.truth = sequence.truth;
    return input;
}

MadeInput make_depth(const SuiteCase& entry, std::uint64_t seed, const fs::path& folder) {
    constexpr double kDistance_mm = 500, kElevation_deg = 40;
    const CameraModel camera{640, 480, {1500, 1500}, {319.5, 239.5}, {-0.1, 0.05, 0.0005, -0.0004, 0}};
    const Scene scene = make_scene(resolved(entry.scene, seed));
    const Eigen::Isometry3d pose = front_view(scene, kDistance_mm, kElevation_deg);
    MadeInput input;
    input.file = write_depth_capture(make_depth_picture(scene, camera, pose, {}, seed, 0), camera, pose, {}, folder);
    input.truth = scene.truth;
    return input;
}

/// The scan of the balls as text, and the nominal file that says where they are on the part.
MadeInput make_balls(std::uint64_t seed, const fs::path& folder) {
    const BallScene scene;
    const FixtureScan made = make_ball_scan(scene, seed);
    std::string points = "# mm\n";
    for (std::size_t i = 0; i < made.scan.points.size(); ++i) {
        const Eigen::Vector3d p = made.scan.position(i);
        points += fixed(p.x(), 5) + " " + fixed(p.y(), 5) + " " + fixed(p.z(), 5) + "\n";
    }
    Json balls = Json::array();
    for (const NamedPoint& ball : scene.balls) {
        balls.push_back({{"name", ball.name}, {"p_mm", {ball.p.x(), ball.p.y(), ball.p.z()}}});
    }
    const Json nominal{
        {"name", "fixture"},
        {"method", "balls"},
        {"ball_diameter_mm", scene.diameter_mm},
        {"balls", std::move(balls)},
        {"work_points", {{{"name", "near"}, {"p_mm", {200, 150, 60}}}, {{"name", "far"}, {"p_mm", {600, 450, 100}}}}}};
    const RunFolder files(folder);
    files.write("scan.xyz", points);
    files.write("nominal.json", nominal.dump(2) + "\n");
    MadeInput input;
    input.file = folder / "scan.xyz";
    input.nominal = folder / "nominal.json";
    input.base_from_part = made.base_from_part;
    return input;
}

}  // namespace

MadeInput make_input(const SuiteCase& entry, std::uint64_t seed, const fs::path& folder) {
    switch (entry.input) {
        case CaseInput::scan:
            return make_scan(entry, seed, folder);
        case CaseInput::laser_stripe:
            return make_stripes(entry, seed, folder);
        case CaseInput::depth:
            return make_depth(entry, seed, folder);
        case CaseInput::balls:
            return make_balls(seed, folder);
        case CaseInput::files:
            break;
    }
    MadeInput input;
    input.file = entry.files.at(0).path;
    if (!entry.truth_file.empty()) {
        input.truth = read_truth(entry.truth_file);
    }
    return input;
}

}  // namespace seampath
