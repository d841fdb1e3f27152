#include "pipeline/walk.hpp"

#include <algorithm>

#include "pipeline/config.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

constexpr std::size_t kMaxStageBytes = std::size_t{1} << 31;
constexpr std::array<std::string_view, 6> kArtefactNames{"1-scan.json",   "2-seams.json",     "3-nodes.json",
                                                         "4-models.json", "5-deviation.json", "6-plan.json"};

std::size_t index(std::string_view stage) {
    return static_cast<std::size_t>(std::find(kStageNames.begin(), kStageNames.end(), stage) - kStageNames.begin());
}

}  // namespace

void Walk::depend_on(std::string_view stage, const std::string& input) {
    key_ = artefact_key(stage, options_json(part_.config, stage), std::array{key_, input});
}

void Walk::keep(std::string_view stage, const std::string& content) const {
    write(kArtefactNames.at(index(stage)), artefact_text(stage, key_, content));
}

void Walk::write(const std::filesystem::path& name, std::string_view content) const {
    ensure(folder_ != nullptr, "files are written by runs with a folder only");
    stop_if_asked();
    folder_->write(name, content);
}

void Walk::begin(std::string_view stage) {
    stop_if_asked();
    if (progress_.begin) {
        progress_.begin(stage);
    }
    stage_ = stage;
    start_ = std::chrono::steady_clock::now();
}

void Walk::end(Summary summary, bool resumed) {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
    part_.timings.push_back({std::string(stage_), passed.count(), resumed, summary(part_)});
    if (progress_.end) {
        progress_.end(part_.timings.back());
    }
}

void Walk::stop_if_asked() const {
    if (progress_.stop && progress_.stop()) {
        throw Interrupted();
    }
}

std::string Walk::stored(std::string_view stage) const {
    if (folder_ == nullptr || index(stage) >= resume_.recompute_from) {
        return {};
    }
    const auto file = folder_->path() / kArtefactNames.at(index(stage));
    return std::filesystem::exists(file) ? read_file(file, kMaxStageBytes, std::string(stage)) : std::string();
}

}  // namespace seampath
