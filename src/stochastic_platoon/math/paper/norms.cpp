#include "stochastic_platoon/math/paper/norms.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

double sequence_norm(const double* values, std::size_t count, NormOrder order) {
  double sum = 0.0;
  double largest = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double value = std::abs(values[k]);
    largest = std::max(largest, value);
    sum += order == NormOrder::kTwo ? value * value : value;
  }
  if (order == NormOrder::kInfinity) return largest;
  return order == NormOrder::kTwo ? std::sqrt(sum) : sum;
}

ErrorNorms error_norms(const SignalMoments& moments, NormOrder p, NormOrder q) {
  const auto steps = static_cast<std::size_t>(moments.steps);
  ErrorNorms norms;
  for (std::size_t i = 0; i < moments.followers; ++i) {
    check_interruption();
    norms.mean.push_back(sequence_norm(moments.mean.data() + i * steps, steps, p));
    norms.variance.push_back(sequence_norm(moments.variance.data() + i * steps, steps, q));
  }
  return norms;
}

}  // namespace platoon
