#include "pipeline/artefact.hpp"

#include "pipeline/digest.hpp"

namespace seampath {
namespace {

constexpr std::string_view kTail = "\n}\n";

std::string before_key(std::string_view stage) {
    return "{\n\"stage\": \"" + std::string(stage) + "\",\n\"key\": \"";
}

std::string head(std::string_view stage, std::string_view key, std::string_view content_sha256) {
    return before_key(stage) + std::string(key) + "\",\n\"sha256\": \"" + std::string(content_sha256) +
           "\",\n\"content\":\n";
}

}  // namespace

std::string artefact_key(std::string_view stage, std::string_view options, std::span<const std::string> inputs) {
    // lengths first, so that no two different lists join to the same text
    std::string all = build_id();
    const auto add = [&all](std::string_view part) {
        all += '\n';
        all += std::to_string(part.size());
        all += ':';
        all += part;
    };
    add(stage);
    add(options);
    for (const auto& input : inputs) {
        add(input);
    }
    return sha256(all);
}

std::string artefact_text(std::string_view stage, std::string_view key, std::string_view content) {
    return head(stage, key, sha256(content)) + std::string(content) + std::string(kTail);
}

std::optional<std::string_view> artefact_content(std::string_view text, std::string_view stage, std::string_view key) {
    const std::size_t head_size = head(stage, key, std::string(64, '0')).size();
    if (text.size() < head_size + kTail.size() || !text.ends_with(kTail)) {
        return {};
    }
    const auto content = text.substr(head_size, text.size() - head_size - kTail.size());
    if (text.substr(0, head_size) != head(stage, key, sha256(content))) {
        return {};
    }
    return content;
}

std::optional<std::string_view> artefact_content(std::string_view text, std::string_view stage) {
    constexpr std::size_t kKeyDigits = 64;
    const std::string before = before_key(stage);
    return text.starts_with(before) ? artefact_content(text, stage, text.substr(before.size(), kKeyDigits))
                                    : std::nullopt;
}

}  // namespace seampath
