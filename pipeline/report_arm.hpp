#pragma once

#include <string>

#include "pipeline/report_rows.hpp"

/// What a report says of the robot arm.
namespace seampath {

ReportRows arm_rows(const ArmTravel& arm);

/// The verdict and, where the arm gets there, every axis over time with its limits, and the manipulability, as HTML;
/// empty without an arm.
std::string arm_section(const PartResult& part);

}  // namespace seampath
