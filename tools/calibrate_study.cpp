#include "tools/calibrate_study.hpp"

#include <iostream>

#include <nlohmann/json.hpp>

#include "pipeline/fixture_history.hpp"
#include "pipeline/fixture_study.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"
#include "tools/exit_status.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

std::vector<HistoryRow> rows_of(const StudyArguments& given) {
    return read_history(std::filesystem::path(given.folder) / "history.db");
}

Json row_json(const HistoryRow& row) {
    const Eigen::Vector3d p = row.base_from_part.translation();
    const Eigen::Quaterniond q(row.base_from_part.linear());
    return {{"date", row.date},
            {"fixture", row.fixture},
            {"method", row.method},
            {"appraiser", row.appraiser},
            {"part", row.part},
            {"verdict", row.pass ? "pass" : "fail"},
            {"accepted", row.accepted},
            {"reason", row.reason},
            {"position_mm", {p.x(), p.y(), p.z()}},
            {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}},
            {"expanded_uncertainty_mm", row.expanded_mm},
            {"nominal_sha256", row.nominal_sha256},
            {"observations_sha256", row.observations_sha256},
            {"faults", row.faults}};
}

Json gauge_json(const FixtureStudy& study) {
    const GaugeStudy& g = *study.gauge;
    return {{"of", study.gauge_of},
            {"parts", g.parts},
            {"appraisers", g.appraisers},
            {"trials", g.trials},
            {"repeatability_mm", g.repeatability},
            {"reproducibility_mm", g.reproducibility},
            {"part_variation_mm", g.part_variation},
            {"grr_mm", g.gauge},
            {"grr_percent_of_tolerance", g.percent_of_tolerance},
            {"distinct_categories", g.distinct_categories}};
}

std::string study_json(const FixtureStudy& study) {
    Json charts = Json::array();
    for (const DriftChart& chart : study.charts) {
        charts.push_back({{"name", chart.name},
                          {"mean_mm", chart.mean},
                          {"value_mm", chart.value},
                          {"control_limit_mm", chart.limit},
                          {"slope_mm_per_run", chart.slope},
                          {"slope_sigmas", chart.slope_sigmas}});
    }
    const Json json{{"runs", study.runs},         {"largest_shift_mm", study.largest_shift_mm},
                    {"gauge", gauge_json(study)}, {"charts", std::move(charts)},
                    {"alarms", study.alarms},     {"notes", study.notes}};
    return json.dump(2) + "\n";
}

std::string study_text(const FixtureStudy& study) {
    const GaugeStudy& g = *study.gauge;
    Rows rows{{"work point", "sd mm", "control limit mm", "drift mm/run", "in sigma"}};
    for (const DriftChart& chart : study.charts) {
        double squares = 0;
        for (const double v : chart.value) {
            squares += v * v;
        }
        rows.push_back({chart.name, fixed(std::sqrt(squares / static_cast<double>(chart.value.size() - 1)), 5),
                        fixed(chart.limit, 5), fixed(chart.slope, 6), fixed(chart.slope_sigmas, 1)});
    }
    std::string text = std::to_string(study.runs) +
                       " runs; largest shift of a work point, first to last: " + fixed(study.largest_shift_mm, 4) +
                       " mm\n\n" + aligned(rows) + "\n";
    rows = {{"gauge R&R (" + study.gauge_of + ")", "sd mm"},
            {"repeatability (EV)", fixed(g.repeatability, 5)},
            {"reproducibility (AV)", fixed(g.reproducibility, 5)},
            {"gauge (GRR)", fixed(g.gauge, 5)},
            {"parts (PV)", fixed(g.part_variation, 5)},
            {"GRR of the tolerance", fixed(g.percent_of_tolerance, 1) + " %"},
            {"distinct categories", fixed(g.distinct_categories, 1)}};
    text += aligned(rows);
    for (const auto& note : study.notes) {
        text += "note: " + note + "\n";
    }
    for (const auto& alarm : study.alarms) {
        text += "ALARM: " + alarm + "\n";
    }
    return text;
}

}  // namespace

CLI::App* history_app(CLI::App& calibrate, StudyArguments& given) {
    CLI::App* app = calibrate.add_subcommand("history", "every calibration of a folder");
    app->add_option("FOLDER", given.folder, "--out folder of the calibrations")->required();
    app->add_flag("--json", given.json, "one array of objects");
    app->footer(
        "Examples:\n"
        "  seampath calibrate history cal/jig7\n"
        "  seampath calibrate history cal/jig7 --json\n"
        "  sqlite3 cal/jig7/history.db 'SELECT date, pass, expanded_mm FROM fixture_calibration'\n");
    return app;
}

CLI::App* study_app(CLI::App& calibrate, StudyArguments& given) {
    CLI::App* app = calibrate.add_subcommand("study", "repeatability (gauge R&R), control limits and drift over runs");
    app->add_option("FOLDER", given.folder, "--out folder of the calibrations")->required();
    app->add_option("--limit", given.limit_mm, "largest shift of a work point without alarm, mm; half the tolerance")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    app->add_flag("--json", given.json, "one object");
    app->footer(
        "Examples:\n"
        "  seampath calibrate study cal/jig7\n"
        "  seampath calibrate study cal/jig7 --limit 0.1\n"
        "  seampath calibrate study cal/jig7 --json\n");
    return app;
}

int print_history(const StudyArguments& given) {
    const auto history = rows_of(given);
    if (given.json) {
        Json list = Json::array();
        for (const HistoryRow& row : history) {
            list.push_back(row_json(row));
        }
        std::cout << list.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
        return kPass;
    }
    Rows rows{{"date", "fixture", "method", "verdict", "x", "y", "z", "expanded mm", "accepted"}};
    for (const HistoryRow& row : history) {
        const Eigen::Vector3d p = row.base_from_part.translation();
        rows.push_back({row.date, row.fixture, row.method, row.pass ? "pass" : "fail", fixed(p.x(), 4), fixed(p.y(), 4),
                        fixed(p.z(), 4), fixed(row.expanded_mm, 4), row.accepted ? row.reason : ""});
    }
    std::cout << aligned(rows);
    return kPass;
}

int print_study(const StudyArguments& given) {
    const FixtureStudy study = study_fixture(rows_of(given), given.limit_mm);
    std::cout << (given.json ? study_json(study) : study_text(study));
    return study.alarms.empty() ? kPass : kOutOfTolerance;
}

}  // namespace seampath
