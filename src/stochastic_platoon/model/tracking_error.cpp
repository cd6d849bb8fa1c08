#include "stochastic_platoon/model/tracking_error.hpp"

#include "stochastic_platoon/model/vector_clones.hpp"

namespace platoon {

namespace detail {

PLATOON_VECTOR_CLONES
void tracking_errors(double headway, double distance, const double* predecessor, const double* own,
                     const double* own_before, std::size_t count, double* errors) {
  for (std::size_t r = 0; r < count; ++r) {
    errors[r] = predecessor[r] - own[r] - distance - headway * (own[r] - own_before[r]);
  }
}

}  // namespace detail

void TrackingError::operator()(const double* predecessor, const double* own, const double* own_before,
                               std::size_t count, double* errors) const {
  detail::tracking_errors(headway, standstill_distance, predecessor, own, own_before, count, errors);
}

}  // namespace platoon
