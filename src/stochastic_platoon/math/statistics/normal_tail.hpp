#pragma once

namespace platoon {

/// ln P(x > a) of a standard normal x, also where P is below the range of double: 1e-14 relative in P.
double log_normal_tail(double a);

/// The a with ln P(x > a) = log_probability, which must be below ln(1/2).
double normal_tail_quantile(double log_probability);

}  // namespace platoon
