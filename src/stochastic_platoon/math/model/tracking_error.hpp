#pragma once

#include <cstddef>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/model/vector_clones.hpp"

namespace platoon {

/// zeta_i(k) = y_{i-1}(k) - y_i(k) - delta - h [y_i(k) - y_i(k-1)] [m], paper eq. (error1), including the distance
/// delta.
struct TrackingError {
  double headway;              ///< h, in sample periods
  double standstill_distance;  ///< delta [m]

  PLATOON_INLINE double operator()(double predecessor, double own, double own_before) const {
    return predecessor - own - standstill_distance - headway * (own - own_before);
  }

  /// The same for `count` realizations. Every pointer refers to `count` values [m]; the ranges do not overlap.
  void operator()(const double* predecessor, const double* own, const double* own_before, std::size_t count,
                  double* errors) const;
};

/// Tracking error of follower i >= 1, with its own headway and distance.
TrackingError tracking_error(const PlatoonModel& model, std::size_t follower);

}  // namespace platoon
