#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Stationary means and variances of the tracking errors of followers 1, ..., N. NaN throughout if the platoon is not
/// mean square stable. All functions throw std::invalid_argument unless followers >= 1, and for a model
/// without theory: see no_theory().

/// Variances P_1, ..., P_N [m^2]; in the paper's platoon, by corollary cor:stationary_all and eq. (pzeta),
/// \f[ P_1 = \|H T\|_2^2 P_d, \qquad P_i = P_{i-1} + \|S T^{i-1}\|_2^2 P_d, \f]
/// and in general by the spectra of StationaryTheory. 1e-12 relative, 1e-11 where vehicles hear others than their
/// predecessor. In a string unstable platoon they grow without bound, to infinity if they leave the range of double.
std::vector<double> stationary_variances(const PlatoonModel& model, std::size_t followers);

/// The shares of the inputs in these variances [m^2], from noise and losses of all vehicles, per follower in the order
/// of VehicleModel::inputs; losses of a packet count for the first of its inputs. Infinite or NaN where the variance
/// is.
std::vector<std::vector<double>> stationary_variances_by_input(const PlatoonModel& model, std::size_t followers);

/// Means at the leader's last speed [m]: v times the mean lag of the received position.
std::vector<double> stationary_means(const PlatoonModel& model, std::size_t followers);

/// The leader's last speed, in metres per step.
double metres_per_step(const PlatoonModel& model);

}  // namespace platoon
