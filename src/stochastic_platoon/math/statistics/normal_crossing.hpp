#pragma once

namespace platoon {

/// A normal distribution. The variance may be 0: then the value is the mean.
struct NormalLaw {
  double mean, variance;
};

/// \f$ P(x < 0) = \Phi(-\mu / \sigma) \f$ with mean mu and standard deviation sigma, without cancellation in the tails.
/// NaN for NaN; 1/2 at infinite variance.
double probability_below_zero(const NormalLaw& x);

/// P(x >= 0, y < 0) for jointly normal x and y, given the variance of y - x. With a = mean of x / standard deviation, b
/// the same of y, and correlation rho = cos theta,
/// \f[ P = \max(\Phi(a) - \Phi(b), 0) + \frac{1}{\pi} \int_0^{\theta/2}
///     \exp(-\frac{(a-b)^2}{8 \sin^2 t} - \frac{(a+b)^2}{8 \cos^2 t}) dt, \f]
/// in which no terms cancel: 1e-12 relative, beyond the effect of rounded arguments. For equal distributions this is 2
/// T(a, tan(theta/2)), T Owen's function (D. B. Owen, Ann. Math. Stat. 27, 1956). NaN for NaN and for infinite
/// variances.
double probability_of_crossing(const NormalLaw& x, const NormalLaw& y, double variance_of_change);

/// The mean at which P(x < 0) = probability, which must be in (0, 1/2): standard deviation times the normal quantile.
double mean_needed(double variance, double probability);

}  // namespace platoon
