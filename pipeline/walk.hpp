#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

#include "pipeline/artefact.hpp"
#include "pipeline/codec.hpp"
#include "pipeline/files.hpp"
#include "pipeline/run.hpp"

namespace seampath {

/// Walks the stages of one run: announces each, takes its result from the artefact of an earlier run or computes and
/// keeps it. Without a folder nothing is kept or taken over.
class Walk {
public:
    Walk(PartResult& part, const Progress& progress, const RunFolder* folder = nullptr, const Resume& resume = {})
        : part_(part), progress_(progress), folder_(folder), resume_(resume) {}

    using Summary = std::string (*)(const PartResult&);

    /// Runs work that is done in every run.
    template <class Work>
    void always(std::string_view stage, const Work& work, Summary summary) {
        begin(stage);
        work();
        end(summary, false);
    }

    /// Runs one stage whose result follows from its options, the stages before it and `input`.
    template <class Result, class Work>
    void stage(std::string_view stage, Result& result, const Work& work, Summary summary,
               const std::string& input = {}) {
        begin(stage);
        depend_on(stage, input);
        const bool resumed = load(stage, result);
        if (!resumed) {
            result = work();
            if (folder_ != nullptr) {
                keep(stage, encode(result));
            }
        }
        end(summary, resumed);
    }

    /// One result for each of `count` seams.
    template <class Function>
    auto each(std::size_t count, const Function& function) const {
        std::vector<decltype(function(count))> results;
        for (std::size_t i = 0; i < count; ++i) {
            stop_if_asked();
            results.push_back(function(i));
        }
        return results;
    }

    /// Makes this and all later stages depend on the stage's options and an input.
    void depend_on(std::string_view stage, const std::string& input);

    /// Writes the artefact of a stage.
    void keep(std::string_view stage, const std::string& content) const;

    /// Writes a file of the run folder. Throws Interrupted instead when the run shall stop.
    void write(const std::filesystem::path& name, std::string_view content) const;

private:
    void begin(std::string_view stage);
    void end(Summary summary, bool resumed);
    void stop_if_asked() const;

    /// The text of the stage's artefact, or empty when none may be used.
    std::string stored(std::string_view stage) const;

    template <class Result>
    bool load(std::string_view stage, Result& result) const {
        const std::string text = stored(stage);
        const auto content = artefact_content(text, stage, key_);
        if (content) {
            decode(*content, result);
        }
        return content.has_value();
    }

    PartResult& part_;
    const Progress& progress_;
    const RunFolder* folder_;
    Resume resume_;
    std::string key_;
    std::string_view stage_;
    std::chrono::steady_clock::time_point start_;
};

}  // namespace seampath
