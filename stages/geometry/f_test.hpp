#pragma once

namespace seampath {

/// Probability that an F statistic of k and m degrees of freedom, both at least 1, is at least f: the regularised
/// incomplete beta function I_x(m / 2, k / 2) at x = m / (m + k f), by Lentz's continued fraction (Abramowitz and
/// Stegun 26.5.8 and 26.6.2).
double f_tail(double f, double k, double m);

}  // namespace seampath
