#include "stochastic_platoon/theory/error_moments.hpp"

#include <Eigen/LU>
#include <stdexcept>
#include <string>
#include <utility>

#include "stochastic_platoon/theory/loop_filter.hpp"
#include "stochastic_platoon/theory/recorded_leader.hpp"

namespace platoon {

namespace {

using Sequence = std::vector<double>;

std::size_t checked_steps(std::int64_t steps) {
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  return static_cast<std::size_t>(steps);
}

/// (H u)(k) = (1 + h) u(k) - h u(k-1), where u is zero before it begins.
Sequence with_headway(const Sequence& u, double headway) {
  Sequence result(u.size());
  double before = 0.0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    result[k] = (1.0 + headway) * u[k] - headway * before;
    before = u[k];
  }
  return result;
}

Sequence difference(const Sequence& u, const Sequence& v) {
  Sequence result(u.size());
  for (std::size_t k = 0; k < u.size(); ++k) result[k] = u[k] - v[k];
  return result;
}

/// Responses of zeta_j, zeta_{j+1}, ... to one cause at vehicle j: the first, then T^{m-1} applied to a seed.
class ErrorResponses {
public:
  ErrorResponses(const LoopFilter& filter, Sequence first, Sequence second)
      : filter_(filter), current_(std::move(first)), next_(std::move(second)) {}

  const Sequence& current() const { return current_; }

  void advance() {
    current_ = std::move(next_);
    next_ = filter_(current_);
  }

private:
  const LoopFilter& filter_;
  Sequence current_;
  Sequence next_;
};

/// g_0 = -HT, g_1 = T S, ... from step 0.
ErrorResponses noise_responses(const LoopFilter& filter, double headway, std::size_t steps) {
  Sequence impulse(steps, 0.0);
  impulse[0] = 1.0;
  const Sequence ht = with_headway(filter(impulse), headway);
  const Sequence sensitivity = difference(impulse, ht);
  return {filter, difference(Sequence(steps, 0.0), ht), filter(sensitivity)};
}

/// a_0 = -Hw, a_1 = S w, ... from step -1.
ErrorResponses position_responses(const LoopFilter& filter, const PlatoonModel& model, std::size_t steps) {
  const Sequence w = filter.free_response(unit_equilibrium(model.loop.realization), steps + 1);
  const Sequence hw = with_headway(w, model.headway);
  const Sequence sensitivity_of_w = difference(w, with_headway(filter(w), model.headway));
  return {filter, difference(Sequence(steps + 1, 0.0), hw), sensitivity_of_w};
}

/// r_0(k) - r_0(k-1) [m] without the large positions in it: from the speeds, scaled by the length of one
/// step.
Sequence leader_displacements(const LeaderProfile& profile, std::size_t steps) {
  Sequence moved(steps, 0.0);
  double sample_period = 0.0;
  for (const SpeedChange& change : profile.changes()) {
    if (sample_period == 0.0 && change.value != 0.0) {
      sample_period = profile.position(change.from_step + 1) / change.value;  // r_0 was zero until here
    }
    for (auto k = static_cast<std::size_t>(change.from_step) + 1; k < steps; ++k) {
      moved[k] = sample_period * change.value;
    }
  }
  return moved;
}

}  // namespace

std::vector<double> leader_error(const PlatoonModel& model, std::int64_t steps) {
  const std::size_t count = checked_steps(steps);
  const StateSpace& loop = model.loop.realization;
  unit_equilibrium(loop);
  // With x = e r_0 + g, e = (I - A)^-1 B, the large positions drop out: g(k+1) = A g(k) - e (r_0(k+1) -
  // r_0(k)) and y_0 = T(1) r_0 + C g, where T(1) = 1 up to the digits the model was given with.
  const Eigen::VectorXd equilibrium =
      Eigen::MatrixXd(Eigen::MatrixXd::Identity(loop.order(), loop.order()) - loop.a())
          .fullPivLu()
          .solve(loop.b());
  const bool unit_gain =
      multiplicity_at_one(sensitivity(model.loop.transfer, model.headway).numerator(), 1e-12) > 0;
  const double gain = unit_gain ? 1.0 : static_cast<double>(loop.c() * equilibrium);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(loop.order());
  Sequence error(count, 0.0);
  double lag_before = 0.0;
  const Sequence moved = leader_displacements(model.leader, count);
  for (std::size_t k = 1; k < count; ++k) {
    g = loop.a() * g - equilibrium * moved[k];
    const double lag = loop.c() * g;
    error[k] = (1.0 - gain) * model.leader.position(static_cast<std::int64_t>(k)) -
               model.headway * gain * moved[k] - (1.0 + model.headway) * lag + model.headway * lag_before;
    lag_before = lag;
  }
  return error;
}

ErrorMoments error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const std::size_t count = checked_steps(steps);
  const LoopFilter filter(model.loop.realization);
  Sequence leader = leader_error(model, steps);
  ErrorResponses noise = noise_responses(filter, model.headway, count);
  ErrorResponses position = position_responses(filter, model, count);
  const InitialPosition& initial = model.initial_position;
  const bool placed = initial.mean != 0.0 || initial.variance != 0.0;
  Sequence mean_shift(count, 0.0);
  Sequence variance(count, 0.0);
  ErrorMoments moments{steps, followers, {}, {}};
  moments.mean.reserve(followers * count);
  moments.variance.reserve(followers * count);
  for (std::size_t m = 0; m < followers; ++m) {
    leader = filter(leader);
    double energy = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      const double a = placed ? position.current()[k + 1] : 0.0;
      energy += noise.current()[k] * noise.current()[k];
      mean_shift[k] += initial.mean * a;
      variance[k] += model.noise_variance * energy + initial.variance * a * a;
      moments.mean.push_back(leader[k] + mean_shift[k]);
      moments.variance.push_back(variance[k]);
    }
    noise.advance();
    if (placed) position.advance();
  }
  if (!model.recorded_leader.empty())
    moments.mean = mean_errors_behind_recorded_leader(model, followers, steps);
  return moments;
}

}  // namespace platoon
