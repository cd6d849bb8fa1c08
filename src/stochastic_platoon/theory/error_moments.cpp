#include "stochastic_platoon/theory/error_moments.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/theory/linked_moments.hpp"
#include "stochastic_platoon/theory/loop_response.hpp"
#include "stochastic_platoon/theory/recorded_leader.hpp"

namespace platoon {

namespace {

std::size_t checked_steps(std::int64_t steps) {
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  return static_cast<std::size_t>(steps);
}

using Sequence = LoopResponse::Sequence;

/// (H u)(k) = (1 + h) u(k) - h u(k-1), where u is zero before it begins.
Sequence with_headway(const Sequence& u, double headway) {
  const long double h = headway;
  Sequence result(u.size());
  long double before = 0.0L;
  for (std::size_t k = 0; k < u.size(); ++k) {
    result[k] = (1 + h) * u[k] - h * before;
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
  ErrorResponses(const LoopResponse& loop, Sequence first, Sequence second)
      : loop_(loop), current_(std::move(first)), next_(std::move(second)) {}

  const Sequence& current() const { return current_; }

  void advance() {
    current_ = std::move(next_);
    next_ = loop_(current_);
  }

private:
  const LoopResponse& loop_;
  Sequence current_;
  Sequence next_;
};

/// g_0 = -HT, g_1 = T S, ... from step 0.
ErrorResponses noise_responses(const LoopResponse& loop, double headway, std::size_t steps) {
  Sequence impulse(steps, 0);
  impulse[0] = 1;
  const Sequence ht = with_headway(loop(impulse), headway);
  const Sequence sensitivity = difference(impulse, ht);
  return {loop, difference(Sequence(steps, 0), ht), loop(sensitivity)};
}

/// a_0 = -Hw, a_1 = S w, ... from step -1.
ErrorResponses position_responses(const LoopResponse& loop, double headway, std::size_t steps) {
  const Sequence w = loop.free_response(steps + 1);
  const Sequence hw = with_headway(w, headway);
  const Sequence sensitivity_of_w = difference(w, with_headway(loop(w), headway));
  return {loop, difference(Sequence(steps + 1, 0), hw), sensitivity_of_w};
}

/// r_0(k) - r_0(k-1) [m] from the speeds, without the large positions in it.
std::vector<double> leader_displacements(const PlatoonModel& model, std::size_t steps) {
  std::vector<double> moved(steps, 0.0);
  for (const SpeedChange& change : model.leader.changes()) {
    for (auto k = static_cast<std::size_t>(change.from_step) + 1; k < steps; ++k) {
      moved[k] = model.sample_period * change.value;
    }
  }
  return moved;
}

/// With x = e r_0 + g, e = (I - A)^-1 B, the large positions drop out: g(k+1) = A g(k) - e (r_0(k+1) -
/// r_0(k)) and y_0 = T(1) r_0 + C g, where T(1) = 1 up to the digits the model was given with.
Sequence leader_error_by(const LoopResponse& loop, const PlatoonModel& model, std::size_t count) {
  const long double gain = loop.gain();
  const long double h = model.headway;
  const std::vector<double> displacements = leader_displacements(model, count);
  const Sequence moved(displacements.begin(), displacements.end());
  const Sequence lag = loop.lag(moved);
  Sequence error(count, 0);
  for (std::size_t k = 1; k < count; ++k) {
    error[k] = (1 - gain) * model.leader.position(static_cast<std::int64_t>(k)) - h * gain * moved[k] -
               (1 + h) * lag[k] + h * lag[k - 1];
  }
  return error;
}

}  // namespace

std::vector<double> leader_error(const PlatoonModel& model, std::int64_t steps) {
  const std::size_t count = checked_steps(steps);
  unit_equilibrium(model.loop.realization);
  const Sequence error = leader_error_by(LoopResponse(model.loop), model, count);
  return {error.begin(), error.end()};
}

ErrorMoments error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  if (!is_papers(model)) return linked_error_moments(model, followers, steps);
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const std::size_t count = checked_steps(steps);
  unit_equilibrium(model.loop.realization);
  const LoopResponse loop(model.loop);
  Sequence leader = leader_error_by(loop, model, count);
  ErrorResponses noise = noise_responses(loop, model.headway, count);
  ErrorResponses position = position_responses(loop, model.headway, count);
  const InitialPosition& initial = model.initial_position;
  const bool placed = initial.mean != 0.0 || initial.variance != 0.0;
  Sequence mean_shift(count, 0);
  Sequence variance(count, 0);
  ErrorMoments moments{steps, followers, {}, {}};
  moments.mean.reserve(followers * count);
  moments.variance.reserve(followers * count);
  for (std::size_t m = 0; m < followers; ++m) {
    leader = loop(leader);
    long double energy = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const long double a = placed ? position.current()[k + 1] : 0;
      energy += noise.current()[k] * noise.current()[k];
      mean_shift[k] += initial.mean * a;
      variance[k] += model.noise_variance * energy + initial.variance * a * a;
      moments.mean.push_back(static_cast<double>(leader[k] + mean_shift[k]));
      moments.variance.push_back(static_cast<double>(variance[k]));
    }
    noise.advance();
    if (placed) position.advance();
  }
  if (!model.recorded_leader.empty()) moments.mean = mean_errors_behind_recorded_leader(model, followers, steps);
  return moments;
}

}  // namespace platoon
