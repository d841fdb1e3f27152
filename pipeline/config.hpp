#pragma once

#include "stages/export/export.hpp"
#include "stages/extract/extract.hpp"
#include "stages/fit/fit.hpp"
#include "stages/place/place.hpp"
#include "stages/plan/plan.hpp"
#include "stages/read/read.hpp"
#include "stages/validate/validate.hpp"

namespace seampath {

/// One options struct a stage; the keys of the config file are the members' names (`export` for `export_`).
struct Config {
    ReadOptions read;
    ExtractOptions extract;
    PlaceOptions place;
    FitOptions fit;
    ValidateOptions validate;
    PlanOptions plan;
    ExportOptions export_;
};

}  // namespace seampath
