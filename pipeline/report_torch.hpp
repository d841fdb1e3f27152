#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/result.hpp"
#include "pipeline/svg.hpp"

namespace seampath {

/// Over the station, degrees, as plan.work_angle_deg and plan.travel_angle_deg count them: against the frame that the
/// torch has without any lean. A turn about the wire does not show in either. Another pass is another line.
struct TorchAngles {
    std::vector<PlotPoint> work, travel;
    double most = 0;  ///< largest absolute value of both
};

/// Of the weld waypoints of one seam; empty when no torch path was planned for it.
TorchAngles torch_angles(const PartResult& part, std::size_t seam);

/// Those angles as an HTML figure; empty when there are none.
std::string torch_angle_plot(const PartResult& part, std::size_t seam);

}  // namespace seampath
