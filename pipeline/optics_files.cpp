#include "pipeline/optics_files.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/camera_json.hpp"
#include "pipeline/digest.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/picture/picture.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Json = JsonObject::Json;

constexpr std::size_t kMostOpticsBytes = std::size_t{16} << 20;
constexpr std::size_t kMostPictureBytes = std::size_t{256} << 20;
constexpr double kMostBoardPoints = 1000;  // a side

int whole_number(const JsonObject& object, const char* key, double least) {
    const double v = object.number(key);
    if (object.has(key) && !(v >= least && v <= kMostBoardPoints && v == std::floor(v))) {
        object.complain(key, shortest(v) + " is no whole number from " + shortest(least) + " to 1000");
        return 0;
    }
    return static_cast<int>(v);
}

double needed(const JsonObject& object, const char* key) {
    object.member(key);
    return object.positive(key, 1);
}

/// A picture of the size that all must have, once one is known.
GreyImage picture_of(const fs::path& file, std::optional<std::pair<int, int>>& size, std::vector<InputFile>& inputs) {
    const std::string bytes = read_file(file, kMostPictureBytes, "read");
    GreyImage image = decode_picture(bytes, file.string());
    if (size && (image.width != size->first || image.height != size->second)) {
        throw InputError("read: " + file.string() + " has " + std::to_string(image.width) + " x " +
                         std::to_string(image.height) + " pixels; " + std::to_string(size->first) + " x " +
                         std::to_string(size->second) + " were needed, as the camera has; nothing is resized");
    }
    size = {image.width, image.height};
    inputs.push_back({file.string(), sha256(bytes)});
    return image;
}

BoardView view_of(const GreyImage& image, const Board& board, const std::string& name) {
    BoardView view{name, {}};
    for (const SeenPoint& point : find_board(image, board)) {
        view.points.push_back({point.on_board, point.pixel});
    }
    return view;
}

double circle_radius(const Board& board) {
    return board.kind == BoardKind::circles ? board.size_mm / 2 : 0;
}

struct CameraFile {
    std::string name;
    double limit_percent = 0.1;
    Board board;
    std::vector<std::string> images;
};

CameraFile camera_file(const Json& json, std::vector<std::string>& problems) {
    const JsonObject root(json, "", problems, {"name", "limit_percent", "board", "images"});
    CameraFile file;
    file.name = root.text("name");
    file.limit_percent = root.positive("limit_percent", file.limit_percent);
    file.board = board_from(root.member("board"), "/board", problems);
    const Json& images = root.member("images");
    for (std::size_t i = 0; images.is_array() && i < images.size(); ++i) {
        if (!images[i].is_string()) {
            root.complain("images/" + std::to_string(i), json_excerpt(images[i]) + " is no text");
            continue;
        }
        file.images.push_back(images[i].get<std::string>());
    }
    if (root.has("images") && !images.is_array()) {
        root.complain("images", "a list of pictures was needed");
    }
    return file;
}

struct LaserFile {
    std::string name;
    double limit_mm = 0.05;
    Board board;
    Json camera;
    std::vector<std::pair<std::string, std::string>> views;  ///< board, stripe
};

LaserFile laser_file(const Json& json, std::vector<std::string>& problems) {
    const JsonObject root(json, "", problems, {"name", "limit_mm", "board", "camera", "views"});
    LaserFile file;
    file.name = root.text("name");
    file.limit_mm = root.positive("limit_mm", file.limit_mm);
    file.board = board_from(root.member("board"), "/board", problems);
    file.camera = root.member("camera");
    check_camera(file.camera, problems);
    const Json& views = root.member("views");
    if (root.has("views") && !views.is_array()) {
        root.complain("views", "a list of views was needed");
    }
    for (std::size_t i = 0; views.is_array() && i < views.size(); ++i) {
        const JsonObject view(views[i], "/views/" + std::to_string(i), problems, {"board", "stripe"});
        file.views.emplace_back(view.text("board"), view.text("stripe"));
    }
    return file;
}

/// The points of the brightest stripe that lie among the board's points; what lies beside it is another surface's.
std::vector<LitPoint> lit_points(const GreyImage& image, const CameraModel& camera, const Eigen::Isometry3d& place,
                                 const Board& board) {
    const Eigen::Isometry3d board_from_camera = place.inverse();
    const Eigen::Vector3d eye = board_from_camera.translation();
    Eigen::AlignedBox2d printed;
    for (const Vector2d& p : points_of(board)) {
        printed.extend(p);
    }
    std::vector<LitPoint> lit;
    for (const Stripe& stripe : find_stripes(image, 1)) {
        for (const StripePoint& point : stripe.points) {
            const auto direction = direction_of(camera, point.p);
            const Eigen::Vector3d ray = board_from_camera.linear() * direction.value_or(Eigen::Vector3d::UnitZ());
            if (direction && printed.contains(Vector2d((eye - eye.z() / ray.z() * ray).head<2>()))) {
                lit.push_back({point.p, point.normal, point.sigma_px});
            }
        }
    }
    return lit;
}

}  // namespace

Board board_from(const Json& value, const std::string& place, std::vector<std::string>& problems) {
    const JsonObject object(
        value, place, problems,
        {"kind", "columns", "rows", "pitch_mm", "marker_mm", "diameter_mm", "dictionary", "first_marker"});
    Board board;
    board.kind = static_cast<BoardKind>(object.word("kind", kBoardKindNames));
    const bool alone = board.kind == BoardKind::aruco;
    board.columns = whole_number(object, "columns", alone ? 1 : 2);
    board.rows = whole_number(object, "rows", alone ? 1 : 2);
    board.pitch_mm = needed(object, "pitch_mm");
    const bool markers = board.kind == BoardKind::charuco || alone, round = board.kind == BoardKind::circles;
    if (markers) {
        board.size_mm = needed(object, "marker_mm");
        board.dictionary = static_cast<int>(object.word("dictionary", kMarkerDictionaryNames));
    } else if (round) {
        board.size_mm = needed(object, "diameter_mm");
    }
    if (alone && object.has("first_marker")) {
        board.first_marker = whole_number(object, "first_marker", 0);
    }
    if (alone && object.has("rows") && board.columns * board.rows == 1) {
        object.complain("rows", "one marker's four corners say too little of how sure they are; use two or more");
    }
    for (const auto& [key, belongs] : {std::pair("marker_mm", markers), std::pair("dictionary", markers),
                                       std::pair("first_marker", alone), std::pair("diameter_mm", round)}) {
        if (object.has(key) && !belongs) {
            object.complain(key, "does not belong to a board of this kind; leave it out");
        }
    }
    if ((markers || round) && object.has("pitch_mm") && !(board.size_mm < board.pitch_mm)) {
        object.complain(markers ? "marker_mm" : "diameter_mm",
                        shortest(board.size_mm) + " is not below the pitch of " + shortest(board.pitch_mm));
    }
    return board;
}

CameraRun calibrate_camera_file(const fs::path& path) {
    CameraFile file;
    read_json_file(path, kMostOpticsBytes, "camera", "a file that names a board and its pictures was needed",
                   [&](const Json& root, std::vector<std::string>& problems) { file = camera_file(root, problems); });
    CameraRun run;
    run.name = file.name;
    run.board = file.board;
    run.inputs.push_back({path.string(), sha256_of_file(path)});
    std::optional<std::pair<int, int>> size;
    std::vector<BoardView> views;
    for (const std::string& name : file.images) {
        const BoardView view = view_of(picture_of(path.parent_path() / name, size, run.inputs), file.board, name);
        view.points.empty() ? run.without_board.push_back(name) : views.push_back(view);
    }
    CameraOptions options;
    options.width = size ? size->first : 0;
    options.height = size ? size->second : 0;
    options.circle_radius_mm = circle_radius(file.board);
    options.limit_percent = file.limit_percent;
    run.result = calibrate_camera(views, options);
    return run;
}

void check_camera(const Json& value, std::vector<std::string>& problems) {
    if (!value.is_string()) {
        camera_from(value, "/camera", problems);
    }
}

CameraModel camera_or_result(const Json& value, const fs::path& folder) {
    std::vector<std::string> none;
    return value.is_string() ? read_camera_result(folder / value.get<std::string>()) : camera_from(value, "", none);
}

BoardPlace locate_in_picture(const fs::path& picture, const CameraModel& camera, const Board& board,
                             std::vector<InputFile>& inputs) {
    std::optional<std::pair<int, int>> size{{camera.width, camera.height}};
    const BoardView view = view_of(picture_of(picture, size, inputs), board, picture.string());
    if (view.points.empty()) {
        throw InputError("board: " + picture.string() +
                         ": the board is not seen; one that is whole in the picture, sharp and evenly lit was needed; "
                         "check its kind and numbers");
    }
    return locate_board(camera, view, circle_radius(board));
}

LaserRun calibrate_laser_file(const fs::path& path) {
    LaserFile file;
    read_json_file(path, kMostOpticsBytes, "laser", "a file that names camera, board and views was needed",
                   [&](const Json& root, std::vector<std::string>& problems) { file = laser_file(root, problems); });
    LaserRun run;
    run.name = file.name;
    run.inputs.push_back({path.string(), sha256_of_file(path)});
    run.camera = camera_or_result(file.camera, path.parent_path());
    std::optional<std::pair<int, int>> size{{run.camera.width, run.camera.height}};
    std::vector<LitView> views;
    for (const auto& [board_name, stripe_name] : file.views) {
        const fs::path board_path = path.parent_path() / board_name, stripe_path = path.parent_path() / stripe_name;
        LitView view{board_name, locate_in_picture(board_path, run.camera, file.board, run.inputs), {}};
        view.points =
            lit_points(picture_of(stripe_path, size, run.inputs), run.camera, view.board.camera_from_board, file.board);
        if (view.points.empty()) {
            throw InputError("laser: " + stripe_path.string() +
                             ": there is no laser line on the board; a picture of the line at the board's same place "
                             "was needed");
        }
        views.push_back(std::move(view));
    }
    run.result = calibrate_laser(run.camera, views, file.limit_mm);
    return run;
}

LaserPlane laser_plane_of(const Plane& plane) {
    // Its distance above 0, so that the same plane is always the same numbers.
    const double distance = plane.normal.dot(plane.point);
    return {distance < 0 ? Eigen::Vector3d(-plane.normal) : plane.normal, std::abs(distance)};
}

}  // namespace seampath
