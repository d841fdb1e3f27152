#include <iostream>
#include <memory>

#include "pipeline/config.hpp"
#include "tools/commands.hpp"

namespace seampath {

Command options_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand("options", "every option: key, unit, default, values, meaning");
    struct Arguments {
        std::string stage;
        bool schema = false;
    };
    const auto given = std::make_shared<Arguments>();
    app->add_option("STAGE", given->stage, "only this stage: read, extract, place, fit, validate, plan or export");
    app->add_flag("--json-schema", given->schema, "JSON schema of the config file, for editors");
    app->footer(
        "Examples:\n"
        "  seampath options\n"
        "  seampath options place\n"
        "  seampath options --json-schema > seampath.schema.json\n");
    return {app, [given] {
                std::cout << (given->schema ? config_schema() : options_table(given->stage));
                return kPass;
            }};
}

}  // namespace seampath
