#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/string_theory.hpp"

namespace platoon {

/// Stationary means and variances of the tracking errors of followers 1, ..., N. NaN throughout if the platoon is not
/// mean square stable. With a model, by the theory that covers it; they throw std::invalid_argument for a model without
/// one, see no_theory().

/// Variances P_1, ..., P_N [m^2]; in the paper's platoon, by corollary cor:stationary_all and eq. (pzeta),
/// \f[ P_1 = \|H T\|_2^2 P_d, \qquad P_i = P_{i-1} + \|S T^{i-1}\|_2^2 P_d, \f]
/// and in general by the spectra of the theory. 1e-12 relative, 1e-11 where vehicles hear others than their
/// predecessor. In a string unstable platoon they grow without bound, to infinity if they leave the range of double.
std::vector<double> stationary_variances(const StringTheory& theory, std::size_t followers);
inline std::vector<double> stationary_variances(const PlatoonModel& model, std::size_t followers) {
  return stationary_variances(*StringTheory::of(model), followers);
}

/// The shares of the inputs in these variances [m^2], from noise and losses of all vehicles, per follower in the order
/// of VehicleModel::inputs; losses of a packet count for the first of its inputs. Infinite or NaN where the variance
/// is.
std::vector<std::vector<double>> stationary_variances_by_input(const StringTheory& theory, std::size_t followers);

/// Means at the leader's last speed [m]: v times the mean lag of the received position.
inline std::vector<double> stationary_means(const PlatoonModel& model, std::size_t followers) {
  return StringTheory::of(model)->means(followers);
}

/// The leader's last speed, in metres per step.
double metres_per_step(const PlatoonModel& model);

}  // namespace platoon
