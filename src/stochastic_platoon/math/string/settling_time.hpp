#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// The time in which the transient of the start decays, for any number of followers: the slowest pole of the string is
/// found once.
class SettlingTime {
public:
  explicit SettlingTime(const PlatoonModel& model);

  /// settling_steps() of this number of followers.
  std::optional<std::int64_t> steps(std::size_t followers) const;

private:
  std::vector<VehicleModel> vehicles_;  ///< one repetition of the string
  double radius_ = 0.0;                 ///< rho
};

constexpr double kRestOfStart = 1e-6;  ///< what a burn-in leaves of the transient of the start

/// Steps after which the transient of the start has decayed to kRestOfStart at follower N; none if a vehicle of the
/// string is unstable:
/// \f[ k = \sum_i (n_i + m_i) + \frac{N + \sqrt{2 N L} + L}{-\ln \rho}, \qquad L = \ln 10^6, \f]
/// the quantile of a sum of N exponential delays with the slowest decay (B. Laurent and P. Massart, Ann. Statist. 28,
/// 2000, lemma 1). rho is the largest modulus of a pole of the closed loops, the leader's included, and noise filters,
/// at least the square root of the second_moment_radius() of its losses and the memory of their LossChain; n_i is the
/// order of loop i, m_i the delay of link i.
std::optional<std::int64_t> settling_steps(const PlatoonModel& model, std::size_t followers);

}  // namespace platoon
