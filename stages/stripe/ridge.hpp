#pragma once

#include "stages/stripe/chains.hpp"
#include "stages/stripe/stripe.hpp"

namespace seampath {

/// The ridge along a chain of bars, by Steger's method; see stripe.hpp. The slope of the ground beside the stripe, e.g.
/// of an arc's glow, is taken off the derivatives. Bars without a ridge give no point.
Stripe follow_ridge(const GreyImage& image, const Chain& chain, double noise);

}  // namespace seampath
