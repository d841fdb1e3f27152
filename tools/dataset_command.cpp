#include <array>
#include <iostream>
#include <memory>

#include "datasets/dataset.hpp"
#include "pipeline/config.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "tools/commands.hpp"
#include "tools/dataset/suite_commands.hpp"

namespace seampath {
namespace {

struct DatasetArguments {
    std::string scene;
    std::string preset = "standard";
    std::uint64_t seed = 1;
    std::string out;
    std::vector<std::string> set;
};

constexpr std::array<std::string_view, kSceneNames.size()> kSceneMeanings{
    "web on a plate, both sides",
    "web along an S-curve on a plate, both sides",
    "closed box with round corners on a plate",
    "leaning pipe on a plate",
    "pipe on a thicker pipe, upright",
    "pipe on a thicker pipe, leaning and offset",
    "pipe on a pipe that is hardly thicker",
    "plate lapped on another; straight, arc or S-curve",
    "plates edge to edge, with gap and mismatch; straight or arc",
    "single V or, with scene.single_bevel, single bevel; straight or arc",
    "outer corner of two plates; straight or arc",
    "lap, stiffener, pipe and corner on one plate: five seams",
    "machined plate with steps and holes, without any joint",
    "tee or lap (scene.spattered) under spatter and tack welds",
};

SceneKind scene_kind(const std::string& scene) {
    for (std::size_t i = 0; i < kSceneNames.size(); ++i) {
        if (kSceneNames[i] == scene) {
            return static_cast<SceneKind>(i);
        }
    }
    throw InputError("dataset: \"" + scene + "\" is no scene; there are " + join(kSceneNames) +
                     hint(scene, kSceneNames));
}

int make(const DatasetArguments& given) {
    SceneOptions scene;
    scene.kind = scene_kind(given.scene);
    ScannerOptions scanner = preset(given.preset);
    std::vector<Override> overrides;
    for (const auto& argument : given.set) {
        overrides.push_back(parse_override(argument));
    }
    apply_overrides({{"scene", describe(scene)}, {"scanner", describe(scanner)}}, overrides);
    const Dataset dataset = make_dataset(scene, scanner, given.seed);
    const std::filesystem::path scan = write_dataset(dataset, given.out);
    const std::size_t seams = dataset.truth.seams.size();
    std::cout << aligned(std::vector<std::vector<std::string>>{
        {scan.string(), std::to_string(dataset.points.size()) + " points"},
        {(scan.parent_path() / "truth.json").string(), std::to_string(seams) + (seams == 1 ? " seam" : " seams")}});
    return kPass;
}

int list() {
    SceneOptions scene;
    ScannerOptions scanner = preset("standard");
    std::vector<std::vector<std::string>> scenes;
    for (std::size_t i = 0; i < kSceneNames.size(); ++i) {
        scenes.push_back({"  " + std::string(kSceneNames[i]), std::string(kSceneMeanings[i])});
    }
    std::cout << "scenes:\n"
              << aligned(scenes) << "\npresets: " << join(kPresetNames)
              << "\n\nWhat --set takes, with the values of preset standard:\n\n"
              << options_table({{"scene", describe(scene)}, {"scanner", describe(scanner)}});
    return kPass;
}

}  // namespace

Command dataset_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("dataset", "scans with known truth, and suites of regression cases");
    app->require_subcommand(1);
    app->footer(
        "Examples:\n"
        "  seampath dataset list\n"
        "  seampath dataset make tee --preset metrology --set scene.lean_deg=20 --out data/tee\n"
        "  seampath dataset run datasets/suites/smoke --out out/smoke\n");
    const auto given = std::make_shared<DatasetArguments>();
    const CLI::App* list_app = app->add_subcommand("list", "scenes, scanner presets, and what --set takes");
    CLI::App* make_app = app->add_subcommand("make", "make a scan and its truth");
    make_app->add_option("SCENE", given->scene, "scene: " + join(kSceneNames))->required();
    make_app->add_option("--preset", given->preset, "scanner: " + join(kPresetNames))->capture_default_str();
    make_app->add_option("--seed", given->seed, "everything random follows from it")->capture_default_str();
    make_app->add_option("--out", given->out, "folder for scan.ply and truth.json")->required();
    make_app->add_option("--set", given->set, "scene.key=value or scanner.key=value")->allow_extra_args(false);
    make_app->footer(
        "Examples:\n"
        "  seampath dataset make tee --out data/tee\n"
        "  seampath dataset make pipe-on-pipe --preset standard --seed 3 --out data/pipe3\n"
        "  seampath dataset make v-groove --set scene.course=arc --set scene.gap_mm=2 --out data/groove\n");
    const std::vector<Command> of_suites{dataset_run_command(*app), dataset_compare_command(*app),
                                         dataset_accept_command(*app), dataset_history_command(*app),
                                         dataset_case_command(*app)};
    return {app, [given, list_app, of_suites] {
                for (const Command& command : of_suites) {
                    if (command.app->parsed()) {
                        return command.act();
                    }
                }
                return list_app->parsed() ? list() : make(*given);
            }};
}

}  // namespace seampath
