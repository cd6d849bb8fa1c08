#include "stochastic_platoon/math/string/error_moments.hpp"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/links/leader_motion.hpp"
#include "stochastic_platoon/math/links/linked_moments.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/links/string_responses.hpp"
#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/linear_model.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/response/loop_filter.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"

namespace platoon {

namespace {

using DoubleSequence = std::vector<double>;

/// Whether T by powers of z and arithmetic in double give the documented accuracy. They do not for a realization given
/// in its own coordinates or for slow poles.
bool has_digits_in_double(const ClosedLoop& loop) {
  constexpr Eigen::Index kHighest = 8;  // order; at higher orders the rounding of many terms adds up
  if (!loop.integrators || loop.realization.order() > kHighest) return false;
  const Polynomial& d = loop.transfer.denominator();
  return std::abs(d.sum()) >= d.cwiseAbs().sum() / 64.0;
}

/// (H u)(k) = (1 + h) u(k) - h u(k-1), with u zero before its first value.
DoubleSequence with_headway(const DoubleSequence& u, double headway) {
  DoubleSequence result(u.size());
  double before = 0.0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    result[k] = (1 + headway) * u[k] - headway * before;
    before = u[k];
  }
  return result;
}

DoubleSequence difference(const DoubleSequence& u, const DoubleSequence& v) {
  DoubleSequence result(u.size());
  for (std::size_t k = 0; k < u.size(); ++k) result[k] = u[k] - v[k];
  return result;
}

/// The paper's platoon in double. The digests of the paper's example depend on the bits of these sums.
class PapersMoments {
public:
  PapersMoments(const PlatoonModel& model, std::size_t steps)
      : model_(model),
        vehicle_(model.default_vehicle()),
        filter_(vehicle_.loop.realization),
        impulse_(steps, 0.0),
        zero_(steps, 0.0) {
    impulse_[0] = 1.0;
  }

  SignalMoments operator()(std::size_t followers) const {
    const std::size_t count = zero_.size();
    const InitialPosition& initial = vehicle_.initial_position;
    const bool placed = initial.mean != 0.0 || initial.variance != 0.0;
    // Responses of zeta_j, zeta_{j+1}, ... to a cause at vehicle j: `now`, then T^{m-1} applied to `next`.
    const DoubleSequence ht = with_headway(filter_(impulse_), vehicle_.headway);
    DoubleSequence noise_now = difference(zero_, ht), noise_next = filter_(difference(impulse_, ht));
    const DoubleSequence w = filter_.free_response(unit_equilibrium(vehicle_.loop.realization), count + 1);
    DoubleSequence placed_now = difference(DoubleSequence(count + 1, 0.0), with_headway(w, vehicle_.headway)),
                   placed_next = difference(w, with_headway(filter_(w), vehicle_.headway));
    DoubleSequence leader = leader_error(), mean_shift(count, 0.0), variance(count, 0.0);
    SignalMoments moments{static_cast<std::int64_t>(count), followers};
    moments.mean.reserve(followers * count);
    moments.variance.reserve(followers * count);
    for (std::size_t m = 0; m < followers; ++m) {
      check_interruption();
      leader = filter_(leader);
      double energy = 0.0;
      for (std::size_t k = 0; k < count; ++k) {
        const double a = placed ? placed_now[k + 1] : 0.0;
        energy += noise_now[k] * noise_now[k];
        mean_shift[k] += initial.mean * a;
        variance[k] += vehicle_.position().noise_variance * energy + initial.variance * a * a;
        moments.mean.push_back(leader[k] + mean_shift[k]);
        moments.variance.push_back(variance[k]);
      }
      advance(noise_now, noise_next);
      if (placed) advance(placed_now, placed_next);
    }
    return moments;
  }

private:
  void advance(DoubleSequence& now, DoubleSequence& next) const {
    now = std::move(next);
    next = filter_(now);
  }

  /// zeta_0(k). With x = e r_0 + g, e = (I - A)^-1 B, the large positions drop out:
  ///     g(k+1) = A g(k) - e (r_0(k+1) - r_0(k)),   y_0 = T(1) r_0 + C g,
  /// with T(1) = 1 up to the digits of the model.
  DoubleSequence leader_error() const {
    const StateSpace& loop = vehicle_.loop.realization;
    const Eigen::VectorXd equilibrium =
        Eigen::MatrixXd(Eigen::MatrixXd::Identity(loop.order(), loop.order()) - loop.a()).fullPivLu().solve(loop.b());
    const double gain = vehicle_.loop.integrators.value_or(0) > 0 ? 1.0 : static_cast<double>(loop.c() * equilibrium);
    const double h = vehicle_.headway;
    Eigen::VectorXd g = Eigen::VectorXd::Zero(loop.order());
    DoubleSequence error(zero_);
    double lag_before = 0.0;
    for (std::size_t k = 1; k < error.size(); ++k) {
      check_interruption();
      const auto step = static_cast<std::int64_t>(k);
      const double moved = model_.sample_period * model_.leader.speed(step - 1);  // r_0(k) - r_0(k-1)
      g = loop.a() * g - equilibrium * moved;
      const double lag = loop.c() * g;
      error[k] = (1 - gain) * model_.leader.position(step) - h * gain * moved - (1 + h) * lag + h * lag_before;
      lag_before = lag;
    }
    return error;
  }

  const PlatoonModel& model_;
  const VehicleModel& vehicle_;
  LoopFilter filter_;
  DoubleSequence impulse_, zero_;
};

}  // namespace

std::vector<double> leader_error(const PlatoonModel& model, std::int64_t steps) {
  if (steps < 1) throw std::invalid_argument("steps: " + std::to_string(steps) + ": must be >= 1");
  unit_equilibrium(model.default_vehicle().loop.realization);
  PlatoonModel profile = model;
  profile.recorded_leader.clear();
  const auto count = static_cast<std::size_t>(steps);
  const Signal error{{1.0, 0}, 0.0, {-model.default_vehicle().headway, 1}};
  std::vector<double> values;
  add_means(error, 0.0, virtual_leader(model, count), leader_motion(profile, count), values);
  return values;
}

SignalMoments error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps,
                            std::vector<double>* fourth_cumulants) {
  if (const auto reason = no_theory(model)) throw std::invalid_argument("no theory, as " + *reason);
  if (needs_chain_moments(model)) return chain_error_moments(model, followers, steps);
  if (!hears_predecessors_only(model)) return hearing_error_moments(model, followers, steps);
  if (start_slope(model) != 0.0) {
    SignalMoments moments = error_moments(in_moving_frame(model), followers, steps, fourth_cumulants);
    for (std::size_t c = 0; c < moments.mean.size(); ++c) {
      const std::size_t follower = c / static_cast<std::size_t>(steps) + 1;
      moments.mean[c] += steady_value(model, tracking_error(model, follower), follower);
    }
    return moments;
  }
  const ClosedLoop& loop = model.default_vehicle().loop;
  const bool in_double = is_papers(model) && model.recorded_leader.empty() && has_digits_in_double(loop);
  if (!in_double || followers < 1 || steps < 1)
    return linked_error_moments(model, followers, steps, loses(model) ? fourth_cumulants : nullptr);
  return PapersMoments(model, static_cast<std::size_t>(steps))(followers);
}

}  // namespace platoon
