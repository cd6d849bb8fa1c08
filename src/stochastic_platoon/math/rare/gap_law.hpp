#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/links/string_responses.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"

namespace platoon {

/// The joint normal law of the gaps over the steps of one realization. The gap of follower i is a linear functional of
/// the standard normal draws g of all links and initial positions j,
/// \f[ g_i(k) = E g_i(k) + \sum_j \sum_{l \le k} f_{ij}(k-l) g_j(l), \qquad
///     C_i(k, \tau) = \sum_j \sum_{l \le \min(k, \tau)} f_{ij}(k-l) f_{ij}(\tau-l). \f]
class GapLaw {
public:
  /// Throws std::invalid_argument as signal_moments() does, and unless has_normal_errors(model).
  GapLaw(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

  std::size_t followers() const { return followers_; }
  std::size_t steps() const { return steps_; }
  double mean(std::size_t follower, std::size_t step) const { return moments_.mean[cell(follower, step)]; }
  double variance(std::size_t follower, std::size_t step) const { return moments_.variance[cell(follower, step)]; }
  const SignalMoments& moments() const { return moments_; }

  /// C_i(k, tau) of followers 1, 2, ..., each steps x steps [m^2]. O(steps^2) per follower and source that differs.
  std::vector<Eigen::MatrixXd> covariances() const;

  /// f(k - l) of the gap of a follower at step k to the normal draw of this name, of step l [m].
  double response(const DrawName& draw, std::size_t follower, std::size_t step) const;

private:
  using Row = std::vector<double>;

  std::size_t cell(std::size_t follower, std::size_t step) const { return (follower - 1) * steps_ + step; }
  /// The covariance of a follower's gaps that the sources of these followers cause.
  Eigen::MatrixXd of_sources(std::size_t first, std::size_t last, std::size_t follower) const;

  std::size_t followers_, steps_;
  DifferentFollowers different_{};
  SignalMoments moments_;
  /// Per follower whose sources differ, of its initial position and of the noise on each of its inputs, the responses
  /// of it and the vehicles behind it; empty without this source.
  std::vector<std::vector<std::vector<Row>>> rows_;
};

}  // namespace platoon
