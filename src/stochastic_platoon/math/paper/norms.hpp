#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/error_moments.hpp"

namespace platoon {

/// The p of an L_p norm (paper, section 2).
enum class NormOrder { kOne, kTwo, kInfinity };

/// (sum_k |v(k)|^p)^{1/p}, or max_k |v(k)|, over `count` values; 0 without values.
double sequence_norm(const double* values, std::size_t count, NormOrder order);

/// The left sides of Definition 1 (def:Lp_Lq_ss), per follower 1 .. N, over the steps of the moments. A variance that
/// settles at a nonzero value has only the infinity norm over infinitely many steps.
struct ErrorNorms {
  std::vector<double> mean;      ///< || mu_{zeta_i} ||_{L_p} [m]
  std::vector<double> variance;  ///< || P_{zeta_i} ||_{L_q} [m^2]
};

ErrorNorms error_norms(const SignalMoments& moments, NormOrder p, NormOrder q);

}  // namespace platoon
