#include <filesystem>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"
#include "tools/browser.hpp"
#include "tools/commands.hpp"
#include "tools/output.hpp"
#include "tools/stop_signal.hpp"

namespace seampath {
namespace {

constexpr std::size_t kMostReportBytes = std::size_t{1} << 31;

nlohmann::ordered_json read_report(const std::filesystem::path& folder) {
    for (const char* name : {"report.json", "report.html"}) {
        if (!std::filesystem::is_regular_file(folder / name)) {
            throw InputError(
                "report: " + folder.string() + " has no " + name +
                "; a folder that \"seampath run\" wrote was needed; of several parts give the folder of one");
        }
    }
    try {
        auto report = parse_json(read_file(folder / "report.json", kMostReportBytes, "report"));
        if (report.is_object() && report.contains("sentence") && report.contains("seams")) {
            return report;
        }
    } catch (const JsonError&) {  // said below
    }
    throw InputError("report: " + (folder / "report.json").string() +
                     " is no report; one that \"seampath run\" wrote was needed; run the scan again");
}

/// Characteristics of all seams, as an inspection sheet lists them.
void print_report(const nlohmann::ordered_json& report) {
    std::vector<std::vector<std::string>> rows{
        {"seam", "characteristic", "nominal", "actual", "uncertainty", "deviation", "tolerance", "out", "verdict"}};
    const auto text = [](const nlohmann::ordered_json& value) {
        return value.is_number() ? fixed(value.get<double>(), 3) : value.is_string() ? value.get<std::string>() : "-";
    };
    for (const auto& seam : report.at("seams")) {
        for (const auto& c : seam.at("characteristics")) {
            rows.push_back({seam.at("seam").dump(), text(c.at("name")), text(c.at("nominal")), text(c.at("actual")),
                            text(c.at("uncertainty")), text(c.at("deviation")), text(c.at("tolerance")),
                            text(c.at("out_of_tolerance")), text(c.at("verdict"))});
        }
    }
    std::cout << text(report.at("part")) << ": " << text(report.at("verdict")) << ": " << text(report.at("sentence"))
              << "\n"
              << (rows.size() > 1 ? aligned(rows) : "");
}

}  // namespace

Command report_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("report", "the verdict of a run, and its report as a PDF");
    struct Arguments {
        std::string run, out;
        bool pdf = false;
    };
    const auto given = std::make_shared<Arguments>();
    app->add_option("RUN", given->run, "folder of a run")->required();
    CLI::Option* pdf = app->add_flag("--pdf", given->pdf, "print report.html to report.pdf beside it, with Chromium");
    app->add_option("--out", given->out, "another name for the PDF")->needs(pdf);
    app->footer(
        "Examples:\n"
        "  seampath report out/tee\n"
        "  seampath report out/tee --pdf\n"
        "  seampath report out/tee --pdf --out tee-0815.pdf\n"
        "Exit status: 0 done, whatever the verdict is, 2 bad input or no browser\n");
    return {app, [given] {
                const std::filesystem::path folder = given->run;
                const nlohmann::ordered_json report = read_report(folder);
                print_report(report);
                if (given->pdf) {
                    watch_stop_signals();
                    const auto file = given->out.empty() ? folder / "report.pdf" : std::filesystem::path(given->out);
                    write_output(file, print_page(folder / "report.html"));
                    std::cout << "pdf       " << file.string() << "\n";
                }
                return kPass;
            }};
}

}  // namespace seampath
