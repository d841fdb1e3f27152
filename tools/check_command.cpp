#include <iostream>
#include <memory>

#include "pipeline/config.hpp"
#include "pipeline/summary.hpp"
#include "tools/commands.hpp"

namespace seampath {

Command check_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("check", "all problems of a config at once, without running it");
    struct Arguments {
        std::string config;
        std::string scan;
    };
    const auto given = std::make_shared<Arguments>();
    app->add_option("CONFIG", given->config, "config file")->required();
    app->add_option("SCAN", given->scan, "also read this scan with the config's unit");
    app->footer(
        "Examples:\n"
        "  seampath check cell3.json\n"
        "  seampath check cell3.json tee.ply\n"
        "  seampath check out/config.resolved.json\n");
    return {app, [given] {
                PartResult part;
                part.config = read_config(given->config);
                std::cout << given->config << ": good\n";
                if (!given->scan.empty()) {
                    part.scan = read(given->scan, part.config.read);
                    std::cout << given->scan << ": " << read_summary(part) << "\n";
                }
                return kPass;
            }};
}

}  // namespace seampath
