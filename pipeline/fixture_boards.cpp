#include <algorithm>

#include <nlohmann/json.hpp>

#include "pipeline/camera_json.hpp"
#include "pipeline/fixture_calibration.hpp"
#include "pipeline/optics_files.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Json = JsonObject::Json;

NominalBoard nominal_board(const Json& value, const std::string& place, std::vector<std::string>& problems) {
    const JsonObject object(value, place, problems, {"name", "board", "part_from_board"});
    NominalBoard board;
    board.name = object.text("name");
    board.board = board_from(object.member("board"), object.place_of("board"), problems);
    board.part_from_board = pose_from(object, "part_from_board");
    return board;
}

// A picture can't tell which is which of two that look alike.
bool look_alike(const Board& a, const Board& b) {
    if (a.kind != b.kind) {
        return false;
    }
    switch (a.kind) {
        case BoardKind::charuco:
            return a.dictionary == b.dictionary;
        case BoardKind::aruco:
            return a.dictionary == b.dictionary && a.first_marker < b.first_marker + b.columns * b.rows &&
                   b.first_marker < a.first_marker + a.columns * a.rows;
        default:
            return a.columns == b.columns && a.rows == b.rows;
    }
}

/// The corners of what is printed on the board.
std::vector<Vector3d> corners_of(const Board& board) {
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p : points_of(board)) {
        box.extend(p);
    }
    return {{box.min().x(), box.min().y(), 0},
            {box.max().x(), box.min().y(), 0},
            {box.max().x(), box.max().y(), 0},
            {box.min().x(), box.max().y(), 0}};
}

}  // namespace

NominalBoards nominal_boards(const JsonObject::Json& value, const std::filesystem::path& folder,
                             std::vector<std::string>& problems) {
    NominalBoards nominal;
    const JsonObject object(value, "", problems, {"boards", "camera", "base_from_camera"});
    const Json &list = object.member("boards"), &camera = object.member("camera");
    if (object.has("boards") && (!list.is_array() || list.empty())) {
        object.complain("boards", "a list of boards was needed");
    }
    for (std::size_t i = 0; list.is_array() && i < list.size(); ++i) {
        const std::string place = "/boards/" + std::to_string(i);
        nominal.boards.push_back(nominal_board(list[i], place, problems));
        const NominalBoard& board = nominal.boards.back();
        for (std::size_t k = 0; k < i; ++k) {
            if (look_alike(board.board, nominal.boards[k].board)) {
                problems.push_back(place + ": looks like \"" + nominal.boards[k].name +
                                   "\" in a picture; boards of other sizes or dictionaries were needed");
            }
        }
    }
    if (object.has("camera")) {
        check_camera(camera, problems);
    }
    if (object.has("base_from_camera")) {
        nominal.base_from_camera = pose_from(object, "base_from_camera");
    }
    if (problems.empty()) {
        nominal.camera = camera_or_result(camera, folder);
        nominal.camera_file = camera.is_string() ? std::optional(folder / camera.get<std::string>()) : std::nullopt;
    }
    return nominal;
}

FrameResult frame_from_boards(const std::filesystem::path& picture, const NominalFixture& nominal,
                              std::vector<MethodNumber>& numbers) {
    std::vector<FrameFeature> features;
    std::string unseen, first_trouble;
    for (const NominalBoard& board : nominal.boards.boards) {
        std::vector<InputFile> again;
        try {
            const BoardPlace found = locate_in_picture(picture, nominal.boards.camera, board.board, again);
            const Eigen::Isometry3d& B = nominal.boards.base_from_camera;
            Matrix6 turn = Matrix6::Zero();
            turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = B.linear();
            const FramePose pose{board.part_from_board, B * found.camera_from_board,
                                 turn * found.covariance * turn.transpose(), corners_of(board.board)};
            features.push_back({board.name, 0, false, {}, {}, {pose}});
            numbers.push_back({board.name + ": scatter of its points", found.rms_px, "px"});
        } catch (const InputError& error) {
            unseen += (unseen.empty() ? "" : ", ") + board.name;
            first_trouble = first_trouble.empty() ? error.what() : first_trouble;
        }
    }
    if (features.empty()) {
        throw InputError(first_trouble);
    }
    FrameResult result = calibrate_frame(std::move(features), nominal.work_points, nominal.frame);
    if (!unseen.empty()) {
        result.notes.push_back("not seen in the picture: " + unseen);
    }
    result.notes.emplace_back(
        "the uncertainty is that of the points in the picture; the camera's own, and that of where the boards are on "
        "the part, come on top");
    return result;
}

}  // namespace seampath
