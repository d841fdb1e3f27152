#pragma once

#include <string>
#include <vector>

#include "pipeline/result.hpp"

/// The tables of a run folder that scripts read (README: files in a run folder).
namespace seampath {

/// Extracted points, scan frame, mm: seam,index,station_mm,x,y,z,n1x,...,sigma_mm. The station is along the polyline.
std::string seam_points_csv(const std::vector<Seam>& seams);

/// The section of every butt joint and V-groove at its points: seam,index,station_mm, then each number and its 1-sigma,
/// empty where the scan does not show it. Empty when there is no such seam.
std::string groove_csv(const std::vector<Seam>& seams);

/// The frame of a part's positions: that of its "scan", or of its "nominal" dimensions.
std::string frame_of(const PartResult& part);

/// Torch poses: comment lines with frame, unit and quaternion order, then seam,index,kind,station_mm,x,...,sigma_mm.
std::string waypoints_csv(const std::vector<Waypoint>& waypoints, const std::string& frame);

/// Passes in the order of travel: comment lines, then seam,pass,layer,bead,across_mm,up_mm,tilt_deg,area_mm2,
/// least_area_mm2,most_area_mm2.
std::string passes_csv(const std::vector<PlannedPass>& passes);

/// The axes of the arm: comment lines, then seam,kind,waypoint,station_mm,time_s,j1_deg,...,j6_deg,roll_deg,
/// manipulability_m3. The waypoint is its row of waypoints.csv from 0, empty between two of them.
std::string joints_csv(const ArmTravel& arm);

/// Per seam: joint kind, closed or open, length, model; where there is a scan, also confidence, points, nodes and
/// deviation.
std::string seams_json(const PartResult& part);

/// For each program file of one robot: its SHA-256, its rounding, and the largest errors found when it was read back.
std::string manifest_json(const std::vector<ProgramFile>& programs, const std::string& robot);

}  // namespace seampath
