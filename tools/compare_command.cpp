#include <filesystem>
#include <iostream>
#include <memory>

#include "pipeline/compare.hpp"
#include "pipeline/text.hpp"
#include "stages/text.hpp"
#include "tools/commands.hpp"
#include "tools/output.hpp"

namespace seampath {
namespace {

/// Differences that nothing judges are many; a terminal shows the largest.
constexpr std::size_t kToldOnTerminal = 12;

std::string digits(const std::optional<double>& value) {
    return value ? fixed(*value, 4) : "-";
}

void print_comparison(const RunComparison& comparison) {
    std::vector<std::vector<std::string>> rows{{"of", "what", "difference", "sigma", "allowed", "share", "verdict"}};
    std::size_t told = 0, left_out = 0;
    for (const Difference& d : comparison.differences) {
        const bool judged = d.verdict != DifferenceVerdict::told;
        if (!judged && told++ >= kToldOnTerminal) {
            ++left_out;
            continue;
        }
        const std::string facts = (d.a.empty() ? "-" : d.a) + " -> " + (d.b.empty() ? "-" : d.b);
        rows.push_back({d.of, d.name, d.difference ? digits(d.difference) : facts, digits(d.sigma), digits(d.allowed),
                        d.allowed ? fixed(100 * d.share(), 0) + " %" : "-", std::string(name(d.verdict))});
    }
    std::cout << (comparison.pass ? "same: " : "different: ") << comparison.sentence << "\n" << aligned(rows);
    if (left_out > 0) {
        std::cout << left_out << " more that are not judged: --json or --out shows them\n";
    }
    for (const Difference& d : comparison.settings) {
        std::cout << "setting   " << d.name << ": " << d.a << " -> " << d.b << "\n";
    }
}

}  // namespace

Command compare_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("compare", "two runs of one part, their differences worst first");
    struct Arguments {
        std::string a, b, out;
        bool json = false;
    };
    const auto given = std::make_shared<Arguments>();
    app->add_option("A", given->a, "folder of a run")->required();
    app->add_option("B", given->b, "folder of another run of the same part, in the same frame")->required();
    app->add_option("--out", given->out, "write a page with both runs overlaid, e.g. differences.html");
    app->add_flag("--json", given->json, "print all differences for machines");
    app->footer(
        "Seams are paired by where they lie. Curves differ where their distance exceeds both 3.41 sigmas of the two "
        "together\nand the smaller tolerance; dimensions with a sigma where they differ by more than 3; the rest is "
        "told, "
        "not judged.\n"
        "Examples:\n"
        "  seampath compare monday/tee friday/tee\n"
        "  seampath compare before after --out differences.html\n"
        "  seampath compare before after --json\n"
        "Exit status: 0 nothing differs, 1 something does, 2 bad input\n");
    return {app, [given] {
                const RunComparison comparison = compare_runs(given->a, given->b);
                if (!given->out.empty()) {
                    write_output(given->out, run_comparison_page(comparison));
                }
                if (given->json) {
                    std::cout << run_comparison_json(comparison);
                } else {
                    print_comparison(comparison);
                }
                return comparison.pass ? kPass : kOutOfTolerance;
            }};
}

}  // namespace seampath
