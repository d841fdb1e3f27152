#include <nlohmann/json.hpp>

#include "pipeline/report.hpp"
#include "pipeline/report_rows.hpp"
#include "pipeline/report_text.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

Json rows_json(const ReportRows& rows) {
    Json list = Json::array();
    for (const ReportRow& row : rows) {
        Json value = std::visit([](const auto& v) { return Json(v); }, row.value);
        list.push_back({{"name", row.name},
                        {"value", std::move(value)},
                        {"unit", row.unit},
                        {"verdict", row.verdict.empty() ? Json() : Json(row.verdict)}});
    }
    return list;
}

Json verdict_json(bool pass) {
    return pass ? "pass" : "fail";
}

/// Without the times, which alone would differ from run to run; they go to the terminal.
Json stages_json(const std::vector<StageTiming>& timings) {
    Json list = Json::array();
    for (const StageTiming& timing : timings) {
        list.push_back({{"stage", timing.stage}, {"summary", valid_utf8(timing.summary)}});
    }
    return list;
}

Json characteristics_json(const std::vector<Characteristic>& characteristics) {
    const auto known = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
    Json list = Json::array();
    for (const Characteristic& c : characteristics) {
        const std::string verdict = c.verdict();
        list.push_back({{"name", c.name},
                        {"unit", c.unit},
                        {"nominal", known(c.nominal)},
                        {"actual", c.actual},
                        {"uncertainty", known(c.uncertainty)},
                        {"deviation", known(c.deviation())},
                        {"tolerance", known(c.tolerance)},
                        {"out_of_tolerance", known(c.out_of_tolerance)},
                        {"verdict", verdict.empty() ? Json() : Json(verdict)}});
    }
    return list;
}

/// A worst place is one object: its rows judge nothing.
Json places_json(const std::vector<ReportRows>& places) {
    Json list = Json::array();
    for (const ReportRows& rows : places) {
        Json place;
        for (const ReportRow& row : rows) {
            place[row.name] = std::visit([](const auto& v) { return Json(v); }, row.value);
        }
        list.push_back(std::move(place));
    }
    return list;
}

Json seams_json(const std::vector<ReportSeam>& seams) {
    Json list = Json::array();
    for (const ReportSeam& seam : seams) {
        list.push_back({{"seam", list.size()},
                        {"verdict", verdict_json(seam.pass)},
                        {"sentence", seam.sentence},
                        {"characteristics", characteristics_json(seam.characteristics)},
                        {"worst_places", places_json(seam.places)},
                        {"rows", rows_json(seam.rows)}});
    }
    return list;
}

}  // namespace

std::string report_json(const PartResult& part) {
    const Report report = report_of(part);
    Json programs = Json::array();
    for (const ReportProgram& program : report.programs) {
        programs.push_back({{"robot", program.robot}, {"file", program.file}, {"rows", rows_json(program.rows)}});
    }
    Json scan;  // null for a nominal part
    if (!part.nominal) {
        scan = {{"rows", rows_json(report.scan)}, {"remarks", report.remarks}};
    }
    const Json json{{"part", report.part},
                    {"verdict", verdict_json(report.pass)},
                    {"sentence", report.sentence},
                    {"identity", rows_json(report.identity)},
                    {"rows", rows_json(report.rows)},
                    {"scan", std::move(scan)},
                    {"seams", seams_json(report.seams)},
                    {"programs", std::move(programs)},
                    {"stages", stages_json(report.timings)}};
    return json.dump(2) + '\n';
}

}  // namespace seampath
