#include "tools/saddle_from.hpp"

#include <iostream>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "pipeline/files.hpp"
#include "pipeline/stored_run.hpp"
#include "stages/error.hpp"
#include "tools/exit_status.hpp"
#include "tools/saddle_difference.hpp"

namespace seampath {
namespace {

struct Saddle {
    std::size_t seam;
    SeamModel model;
};

std::string seam_text(std::size_t seam, const SeamModel& model) {
    return "seam " + std::to_string(seam) + " is a " + model.model + " (" + model.reason + ")";
}

/// The saddles that are asked for, at least one.
std::vector<Saddle> saddles_of(const SaddleFrom& from) {
    std::vector<SeamModel> models = load_models(from.folder);
    if (from.seam && (*from.seam < 0 || static_cast<std::size_t>(*from.seam) >= models.size())) {
        throw InputError("--seam: " + std::to_string(*from.seam) + "; the run has " + std::to_string(models.size()) +
                         " seams, numbered from 0");
    }
    std::vector<Saddle> saddles;
    std::string others;
    for (std::size_t i = 0; i < models.size(); ++i) {
        if (from.seam && static_cast<std::size_t>(*from.seam) != i) {
            continue;
        }
        if (models[i].saddle) {
            saddles.push_back({i, std::move(models[i])});
        } else {
            others += (others.empty() ? "" : "; ") + seam_text(i, models[i]);
        }
    }
    if (saddles.empty()) {
        throw InputError("--from: " + from.folder.string() + " holds no fitted saddle" +
                         (from.seam ? " of that number" : "") + ": " + (others.empty() ? "it has no seams" : others) +
                         "; a run was needed in which fit.model, auto or saddle, took a seam for one");
    }
    return saddles;
}

/// What the differences don't show: how an open seam is off the saddle of its dimensions.
std::string offset_remark(const std::vector<Saddle>& saddles) {
    std::string seams;
    for (const Saddle& saddle : saddles) {
        if (has_offsets(saddle.model) && !saddle.model.closed) {
            seams += (seams.empty() ? "seam " : ", ") + std::to_string(saddle.seam);
        }
    }
    return seams.empty() ? "" : seams + ": the fitted seam's smooth offsets from its saddle are not in the differences";
}

/// The fit may have been told what it is now held against.
std::string prior_remark(const SaddleFrom& from) {
    const FitOptions fit = read_config(from.folder / "config.resolved.json").fit;
    for (const auto* known : {&fit.branch_radius_mm, &fit.header_radius_mm, &fit.angle_deg, &fit.offset_mm}) {
        if ((*known)[1] > 0) {
            return "the fit knew dimensions beforehand (fit.branch_radius_mm, header_radius_mm, angle_deg or "
                   "offset_mm): it leans towards them";
        }
    }
    return "";
}

}  // namespace

SaddleDimensions fitted_dimensions(const SaddleFrom& from) {
    const std::vector<Saddle> saddles = saddles_of(from);
    if (saddles.size() > 1) {
        throw InputError("--from: " + from.folder.string() + " holds " + std::to_string(saddles.size()) +
                         " saddles; say which one with --seam, or give nominal dimensions to compare all with");
    }
    return dimensions_of(*saddles.front().model.saddle, {});
}

int compare_with_nominal(const SaddleFrom& from, const SaddleDimensions& nominal) {
    std::vector<SaddleDifference> differences;
    nlohmann::ordered_json seams = nlohmann::ordered_json::array();
    std::string text;
    const std::vector<Saddle> saddles = saddles_of(from);
    std::string remark = prior_remark(from);
    const std::string offsets = offset_remark(saddles);
    remark += (remark.empty() || offsets.empty() ? "" : "; ") + offsets;
    for (const Saddle& saddle : saddles) {
        differences.push_back(saddle_difference(saddle.seam, saddle.model, nominal));
        text += (text.empty() ? "" : "\n") + seam_text(saddle.seam, saddle.model) + "\n" +
                saddle_difference_text(differences.back());
        seams.push_back(saddle_difference_json(differences.back()));
        seams.back()["model"] = saddle.model.model;
        seams.back()["reason"] = saddle.model.reason;
    }
    const nlohmann::ordered_json json{{"from", from.folder.generic_string()}, {"remark", remark}, {"seams", seams}};
    const std::string json_text = json.dump(4, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    const RunFolder folder(from.out);
    folder.write("saddle_difference.csv", saddle_difference_csv(differences));
    folder.write("saddle_difference.svg", saddle_difference_svg(differences));
    folder.write("saddle_difference.json", json_text);
    if (from.json) {
        std::cout << json_text;
    } else {
        std::cout << text << (remark.empty() ? "" : "note: " + remark + "\n")
                  << "files: " << (from.out / "saddle_difference.{csv,json,svg}").string() << "\n";
    }
    return kPass;
}

}  // namespace seampath
