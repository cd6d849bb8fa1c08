#include "stochastic_platoon/math/model/tracking_error.hpp"

namespace platoon {

namespace detail {

PLATOON_VECTOR_CLONES
void tracking_errors(const TrackingError& error, const double* predecessor, const double* own, const double* own_before,
                     std::size_t count, double* errors) {
  const TrackingError zeta = error;  // a local copy cannot alias `errors`
  for (std::size_t r = 0; r < count; ++r) errors[r] = zeta(predecessor[r], own[r], own_before[r]);
}

}  // namespace detail

void TrackingError::operator()(const double* predecessor, const double* own, const double* own_before,
                               std::size_t count, double* errors) const {
  detail::tracking_errors(*this, predecessor, own, own_before, count, errors);
}

TrackingError tracking_error(const PlatoonModel& model, std::size_t follower) {
  const VehicleModel own = vehicle(model, follower);
  return {own.headway, own.standstill_distance};
}

}  // namespace platoon
