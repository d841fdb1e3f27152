#pragma once

#include <functional>

namespace seampath {

/// Where f is least in [low, high], by golden sections: to 1e-10 of the interval. f has one minimum there.
double golden_section(const std::function<double(double)>& f, double low, double high);

}  // namespace seampath
