#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

/// A frame in the words of the robots' own languages, each read back by a reader of its own.
namespace seampath {

inline constexpr std::array<std::string_view, 7> kFrameFormats{"abb", "kuka", "fanuc", "ur", "yaskawa", "json", "urdf"};

/// One file, and how far its text, read back, is from the frame.
struct FrameFile {
    std::string format;
    std::string name;  ///< without folder
    std::string text;
    double position_error_mm = 0;  ///< at the origin
    double turn_error_rad = 0;
};

/// Writes the frame in each language and reads it back. `name` names it in the files (letters, digits and underscores
/// are kept), `number` is that of the base, user frame or register where the language counts them. Throws InternalError
/// when what is read back differs by more than the rounding written.
std::vector<FrameFile> frame_files(const Eigen::Isometry3d& base_from_part, const std::string& name, int number);

/// The frame that such a text holds. Throws InternalError when it holds none.
Eigen::Isometry3d read_frame(std::string_view format, const std::string& text);

}  // namespace seampath
