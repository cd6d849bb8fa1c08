#include "stochastic_platoon/math/numerics/multiples.hpp"

#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

PLATOON_VECTOR_CLONES
void set_multiple(double factor, const double* in, std::size_t count, double* out) {
  for (std::size_t r = 0; r < count; ++r) out[r] = factor * in[r];
}

PLATOON_VECTOR_CLONES
void add_multiple(double factor, const double* in, std::size_t count, double* out) {
  for (std::size_t r = 0; r < count; ++r) out[r] += factor * in[r];
}

}  // namespace platoon
