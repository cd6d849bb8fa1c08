#pragma once

namespace platoon {

/// A normal distribution. The variance may be 0: then the value is the mean.
struct NormalLaw {
  double mean, variance;
};

/// P(x < 0) = Phi(-mean / standard deviation), without cancellation in the tails. NaN for NaN; 1/2 at infinite
/// variance.
double probability_below_zero(const NormalLaw& x);

/// P(x >= 0, y < 0) for jointly normal x and y, given the variance of y - x. With a = mean of x / standard deviation, b
/// the same of y, and correlation rho = cos theta,
///     P = max(Phi(a) - Phi(b), 0) + 1/pi integral over 0 .. theta/2 of exp(-((a-b)/sin)^2/8 - ((a+b)/cos)^2/8),
/// in which no terms cancel: 1e-12 relative, beyond the effect of rounded arguments. For equal distributions this is 2
/// T(a, tan(theta/2)), T Owen's function (D. B. Owen, Ann. Math. Stat. 27, 1956). NaN for NaN and for infinite
/// variances.
double probability_of_crossing(const NormalLaw& x, const NormalLaw& y, double variance_of_change);

/// The mean at which P(x < 0) = probability, which must be in (0, 1/2): standard deviation times the normal quantile.
double mean_needed(double variance, double probability);

}  // namespace platoon
