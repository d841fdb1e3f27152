#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "stages/export/format.hpp"

/// Private to the export stage: programs that are too long for a controller, in parts that a main program calls.
namespace seampath::exporting {

/// Targets [begin, end).
struct Section {
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// From each way towards a weld to the way back: what must stay in one part.
std::vector<Section> welds_of(const std::vector<Target>& targets);

/// As few parts as hold at most `most` lines each, made of whole welds; `lines` is of each, `head` what every part has
/// besides. Throws InputError where one weld alone has more.
std::vector<Section> parts_of(const std::vector<Target>& targets, const std::vector<Section>& welds,
                              const std::vector<std::size_t>& lines, std::size_t head, std::size_t most,
                              std::string_view robot);

/// What a controller's jobs, whose names are in capitals, keep to.
struct JobLimits {
    std::size_t most_lines;
    std::string_view robot;
    std::string_view call;  ///< what a job calls another with, before its name
};

/// The program as one job, or as a main job that calls parts of whole welds. A Writer is made of targets and options,
/// has `lines`, and takes `write(section)` and `line(text)`; `set_up(writer, program, options)` begins a job and
/// `file(name, writer, options)` ends it.
template <class Writer, class SetUp, class File>
std::vector<TextFile> jobs(const Program& program, const ExportOptions& options, const JobLimits& limits,
                           SetUp&& set_up, File&& file) {
    const std::vector<Target>& all = program.targets;
    std::string name = options.program_name;
    for (char& c : name) {
        c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    }
    Writer head(all, options);
    set_up(head, program, options);
    const std::vector<Section> welds = welds_of(all);
    std::vector<std::size_t> lines;
    for (const Section& weld : welds) {
        Writer writer(all, options);
        writer.write(weld);
        lines.push_back(writer.lines);
    }
    const std::vector<Section> parts = parts_of(all, welds, lines, head.lines, limits.most_lines, limits.robot);
    if (parts.size() == 1) {
        head.write(parts.front());
        return {file(name, head, options)};
    }
    std::vector<TextFile> files(1);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::string part = name + "_" + std::to_string(i);
        head.line(std::string(limits.call) + part);
        Writer writer(all, options);
        set_up(writer, program, options);
        writer.write(parts[i]);
        files.push_back(file(part, writer, options));
    }
    files.front() = file(name, head, options);
    return files;
}

}  // namespace seampath::exporting
