#include "stochastic_platoon/math/string/error_moments.hpp"

#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/string/burst_moments.hpp"
#include "stochastic_platoon/math/string/burst_pattern.hpp"
#include "stochastic_platoon/math/string/linked_moments.hpp"
#include "stochastic_platoon/math/string/loop_filter.hpp"
#include "stochastic_platoon/math/string/loop_response.hpp"
#include "stochastic_platoon/math/string/recorded_leader.hpp"

namespace platoon {

namespace {

std::size_t checked_steps(std::int64_t steps) {
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  return static_cast<std::size_t>(steps);
}

/// The loop as a LoopFilter, with the interface of LoopResponse that the moments need. The digests of the paper's
/// example depend on its bits.
class DoubleFilter {
public:
  using Scalar = double;
  using Sequence = std::vector<double>;

  explicit DoubleFilter(const ClosedLoop& loop)
      : integrates_(loop.integrators.value_or(0) > 0),
        loop_(loop.realization),
        filter_(loop.realization),
        equilibrium_(Eigen::MatrixXd(Eigen::MatrixXd::Identity(loop_.order(), loop_.order()) - loop_.a())
                         .fullPivLu()
                         .solve(loop_.b())) {}

  Sequence operator()(const Sequence& input) const { return filter_(input); }
  Sequence free_response(std::size_t count) const { return filter_.free_response(unit_equilibrium(loop_), count); }
  Scalar gain() const { return integrates_ ? 1.0 : static_cast<double>(loop_.c() * equilibrium_); }
  Sequence lag(const Sequence& moved) const {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(loop_.order());
    Sequence response(moved.size(), 0.0);
    for (std::size_t k = 1; k < moved.size(); ++k) {
      g = loop_.a() * g - equilibrium_ * moved[k];
      response[k] = loop_.c() * g;
    }
    return response;
  }

private:
  bool integrates_;  ///< T(1) = 1
  StateSpace loop_;
  LoopFilter filter_;
  Eigen::VectorXd equilibrium_;  ///< (I - A)^-1 B
};

/// Whether T by powers of z and arithmetic in double give the documented accuracy. They do not for a realization given
/// in its own coordinates or for slow poles.
bool has_digits_in_double(const ClosedLoop& loop) {
  constexpr Eigen::Index kHighest = 8;  // order; at higher orders the rounding of many terms adds up
  if (!loop.integrators || loop.realization.order() > kHighest) return false;
  const Polynomial& d = loop.transfer.denominator();
  return std::abs(d.sum()) >= d.cwiseAbs().sum() / 64.0;
}

/// (H u)(k) = (1 + h) u(k) - h u(k-1), with u zero before its first value.
template <class Sequence>
Sequence with_headway(const Sequence& u, double headway) {
  const typename Sequence::value_type h = headway;
  Sequence result(u.size());
  typename Sequence::value_type before = 0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    result[k] = (1 + h) * u[k] - h * before;
    before = u[k];
  }
  return result;
}

template <class Sequence>
Sequence difference(const Sequence& u, const Sequence& v) {
  Sequence result(u.size());
  for (std::size_t k = 0; k < u.size(); ++k) result[k] = u[k] - v[k];
  return result;
}

/// Responses of zeta_j, zeta_{j+1}, ... to one cause at vehicle j: `first`, then T^{m-1} applied to `second`.
template <class Filter>
class ErrorResponses {
public:
  using Sequence = typename Filter::Sequence;

  ErrorResponses(const Filter& filter, Sequence first, Sequence second)
      : filter_(filter), current_(std::move(first)), next_(std::move(second)) {}

  const Sequence& current() const { return current_; }

  void advance() {
    current_ = std::move(next_);
    next_ = filter_(current_);
  }

private:
  const Filter& filter_;
  Sequence current_;
  Sequence next_;
};

/// g_0 = -HT, g_1 = T S, ... from step 0.
template <class Filter>
ErrorResponses<Filter> noise_responses(const Filter& filter, double headway, std::size_t steps) {
  typename Filter::Sequence impulse(steps, 0);
  impulse[0] = 1;
  const typename Filter::Sequence ht = with_headway(filter(impulse), headway);
  const typename Filter::Sequence sensitivity = difference(impulse, ht);
  return {filter, difference(typename Filter::Sequence(steps, 0), ht), filter(sensitivity)};
}

/// a_0 = -Hw, a_1 = S w, ... from step -1.
template <class Filter>
ErrorResponses<Filter> position_responses(const Filter& filter, double headway, std::size_t steps) {
  const typename Filter::Sequence w = filter.free_response(steps + 1);
  const typename Filter::Sequence hw = with_headway(w, headway);
  const typename Filter::Sequence sensitivity_of_w = difference(w, with_headway(filter(w), headway));
  return {filter, difference(typename Filter::Sequence(steps + 1, 0), hw), sensitivity_of_w};
}

/// r_0(k) - r_0(k-1) [m] from the speeds, without cancellation of large positions.
std::vector<double> leader_displacements(const PlatoonModel& model, std::size_t steps) {
  std::vector<double> moved(steps, 0.0);
  for (const SpeedChange& change : model.leader.changes()) {
    for (auto k = static_cast<std::size_t>(change.from_step) + 1; k < steps; ++k) {
      moved[k] = model.sample_period * change.value;
    }
  }
  return moved;
}

/// zeta_0(k). With x = e r_0 + g, e = (I - A)^-1 B, the large positions drop out:
///     g(k+1) = A g(k) - e (r_0(k+1) - r_0(k)),   y_0 = T(1) r_0 + C g,
/// with T(1) = 1 up to the digits of the model.
template <class Filter>
typename Filter::Sequence leader_error_by(const Filter& filter, const PlatoonModel& model, std::size_t count) {
  using Scalar = typename Filter::Scalar;
  const Scalar gain = filter.gain();
  const Scalar h = model.default_vehicle().headway;
  const std::vector<double> displacements = leader_displacements(model, count);
  const typename Filter::Sequence moved(displacements.begin(), displacements.end());
  const typename Filter::Sequence lag = filter.lag(moved);
  typename Filter::Sequence error(count, 0);
  for (std::size_t k = 1; k < count; ++k) {
    error[k] = (1 - gain) * model.leader.position(static_cast<std::int64_t>(k)) - h * gain * moved[k] -
               (1 + h) * lag[k] + h * lag[k - 1];
  }
  return error;
}

template <class Filter>
ErrorMoments error_moments_by(const Filter& filter, const PlatoonModel& model, std::size_t followers,
                              std::int64_t steps) {
  using Scalar = typename Filter::Scalar;
  const std::size_t count = checked_steps(steps);
  typename Filter::Sequence leader = leader_error_by(filter, model, count);
  ErrorResponses<Filter> noise = noise_responses(filter, model.default_vehicle().headway, count);
  ErrorResponses<Filter> position = position_responses(filter, model.default_vehicle().headway, count);
  const InitialPosition& initial = model.default_vehicle().initial_position;
  const bool placed = initial.mean != 0.0 || initial.variance != 0.0;
  typename Filter::Sequence mean_shift(count, 0);
  typename Filter::Sequence variance(count, 0);
  ErrorMoments moments{steps, followers, {}, {}};
  moments.mean.reserve(followers * count);
  moments.variance.reserve(followers * count);
  for (std::size_t m = 0; m < followers; ++m) {
    leader = filter(leader);
    Scalar energy = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Scalar a = placed ? position.current()[k + 1] : 0;
      energy += noise.current()[k] * noise.current()[k];
      mean_shift[k] += initial.mean * a;
      variance[k] += model.default_vehicle().noise_variance * energy + initial.variance * a * a;
      moments.mean.push_back(static_cast<double>(leader[k] + mean_shift[k]));
      moments.variance.push_back(static_cast<double>(variance[k]));
    }
    noise.advance();
    if (placed) position.advance();
  }
  if (!model.recorded_leader.empty()) moments.mean = mean_errors_behind_recorded_leader(model, followers, steps);
  return moments;
}

}  // namespace

std::vector<double> leader_error(const PlatoonModel& model, std::int64_t steps) {
  const std::size_t count = checked_steps(steps);
  unit_equilibrium(model.default_vehicle().loop.realization);
  if (has_digits_in_double(model.default_vehicle().loop))
    return leader_error_by(DoubleFilter(model.default_vehicle().loop), model, count);
  const LoopResponse::Sequence error = leader_error_by(LoopResponse(model.default_vehicle().loop), model, count);
  return {error.begin(), error.end()};
}

ErrorMoments error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  if (has_bursts(model)) return burst_error_moments(model, followers, steps);
  if (!is_papers(model)) return linked_error_moments(model, followers, steps);
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  unit_equilibrium(model.default_vehicle().loop.realization);
  if (has_digits_in_double(model.default_vehicle().loop))
    return error_moments_by(DoubleFilter(model.default_vehicle().loop), model, followers, steps);
  return error_moments_by(LoopResponse(model.default_vehicle().loop), model, followers, steps);
}

}  // namespace platoon
