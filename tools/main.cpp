#include <algorithm>
#include <csignal>
#include <iostream>
#include <span>

#include "pipeline/text.hpp"
#include "tools/commands.hpp"
#include "tools/failure.hpp"

namespace seampath {
namespace {

constexpr const char* kExamples =
    "Examples:\n"
    "  seampath run tee.ply --out out             scan in, seams, robot programs and report out\n"
    "  seampath options plan                      what can be set for the torch's travel\n"
    "  seampath dataset make tee --seed 1 --out d a scan with known truth to try it on\n";

std::vector<std::string> long_options(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const auto& name : option->get_lnames()) {
            names.push_back("--" + name);
        }
    }
    return names;
}

std::string near(const std::string& word, const std::vector<std::string>& known) {
    const std::vector<std::string_view> views(known.begin(), known.end());
    return hint(word, views);
}

/// The subcommand, or the subcommand's subcommand, that the command line names.
const CLI::App& innermost(const CLI::App& app) {
    const auto chosen = app.get_subcommands();
    return chosen.empty() ? app : innermost(*chosen.front());
}

/// "seampath dataset make"
std::string path_of(const CLI::App& app) {
    return (app.get_parent() ? path_of(*app.get_parent()) + " " : "") + app.get_name();
}

int explain(const CLI::App& program, const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
        return program.exit(error);  // --help and --version
    }
    const CLI::App& app = innermost(program);
    std::string what = error.what();
    for (const auto& word : app.remaining()) {
        if (word.starts_with("-")) {
            const std::string flag = word.substr(0, word.find('='));
            what = "\"" + flag + "\" is no option" + near(flag, long_options(app));
            break;
        }
    }
    const std::string path = path_of(app);
    std::cerr << path << ": " << what << " (see " << path << " --help)\n";
    return kBadInput;
}

/// The parser itself has no near-miss hints for commands.
void check_command_names(const CLI::App& app, std::span<char*> words) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
    }
    const std::string word = words.empty() ? "" : words.front();
    if (names.empty() || word.empty() || word.starts_with("-")) {
        return;
    }
    if (std::find(names.begin(), names.end(), word) == names.end()) {
        const std::vector<std::string_view> views(names.begin(), names.end());
        throw CLI::ArgumentMismatch("\"" + word + "\" is no command; there are " + join(views) + near(word, names));
    }
    check_command_names(*app.get_subcommand(word), words.subspan(1));
}

int run_program(int argc, char** argv) {
    CLI::App program("Seampath: scans of parts in, measured seams and robot programs out.", "seampath");
    program.set_version_flag("--version", "seampath " SEAMPATH_VERSION);
    program.require_subcommand(1);
    program.footer(kExamples);
    const std::vector<Command> commands{
        run_command(program),         check_command(program),   info_command(program),
        options_command(program),     dataset_command(program), interpolate_command(program),
        parametrize_command(program), saddle_command(program),  mechanism_command(program),
        calibrate_command(program),   compare_command(program), report_command(program)};
    try {
        check_command_names(program, std::span(argv, static_cast<std::size_t>(argc)).subspan(1));
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return explain(program, error);
    }
    const auto chosen =
        std::find_if(commands.begin(), commands.end(), [](const Command& c) { return c.app->parsed(); });
    const int status = chosen->act();
    if (!std::cout.flush()) {
        std::cerr << "seampath: cannot write the result to stdout; a pipe or file with space was needed\n";
        return std::max<int>(status, kBadInput);
    }
    return status;
}

}  // namespace
}  // namespace seampath

int main(int argc, char** argv) {
    std::signal(SIGXFSZ, SIG_IGN);  // a file size limit then shows as a failed write with a message, like a full disk
    return seampath::guarded([&] { return seampath::run_program(argc, argv); });
}
