#include "stochastic_platoon/math/string/rounding_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/response/loop_filter.hpp"

namespace platoon {

namespace {

constexpr double kRoundoff = std::numeric_limits<double>::epsilon() / 2.0;

/// Accumulated rounding error per unit of position up to each step, in units of the roundoff.
struct RoundingGains {
  std::vector<double> position;  ///< of y
  std::vector<double> error;     ///< of H y
};

RoundingGains rounding_gains(const StateSpace& vehicle, double headway, std::size_t steps) {
  const Eigen::Index n = vehicle.order();
  using Extended = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::VectorXd equilibrium = unit_equilibrium(vehicle);
  const Extended unsettled = vehicle.a().cast<long double>() * equilibrium.cast<long double>() +
                             vehicle.b().cast<long double>() - equilibrium.cast<long double>();
  const Eigen::VectorXd weights =
      (static_cast<double>(n) + 6.0) * (vehicle.a().cwiseAbs() * equilibrium.cwiseAbs() + vehicle.b().cwiseAbs()) +
      unsettled.cwiseAbs().cast<double>() / kRoundoff;
  const LoopFilter filter(vehicle);
  RoundingGains gains{std::vector<double>(steps, 0.0), std::vector<double>(steps, 0.0)};
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::vector<double> response = filter.free_response(Eigen::VectorXd::Unit(n, j), steps);
    double position = 0.0, error = 0.0, before = 0.0;
    for (std::size_t k = 0; k < steps; ++k) {
      position += std::abs(response[k]);
      error += std::abs(response[k] + headway * (response[k] - before));
      before = response[k];
      gains.position[k] += weights(j) * position;
      gains.error[k] += weights(j) * error;
    }
  }
  return gains;
}

/// M(k) for k = 0 .. steps-1: 1.5 times the leader's largest position, as a vehicle may overshoot, plus the spread.
std::vector<double> largest_positions(const PlatoonModel& model, std::size_t followers, std::size_t steps) {
  constexpr double kDeviations = 8.0;
  double mean = 0.0, variance = 0.0, noise = 0.0;
  for (const VehicleModel& of : pattern(model)) {
    mean = std::max(mean, std::abs(of.initial_position.mean));
    variance = std::max(variance, of.initial_position.variance);
    noise = std::max(noise, of.position().noise_variance);
  }
  const double spread =
      std::abs(start_place(model, followers)) + mean + kDeviations * (std::sqrt(variance) + std::sqrt(noise));
  std::vector<double> largest;
  double farthest = 0.0;
  for (std::size_t k = 0; k < steps; ++k) {
    const double leader = k + 1 < model.recorded_leader.size() ? model.recorded_leader[k + 1]
                                                               : model.leader.position(static_cast<std::int64_t>(k));
    farthest = std::max(farthest, std::abs(leader));
    largest.push_back(spread + 1.5 * farthest);
  }
  return largest;
}

}  // namespace

double rounding_bound_of_a_metre(const StateSpace& vehicle, std::size_t steps) {
  return steps == 0 ? 0.0 : kRoundoff * rounding_gains(vehicle, 0.0, steps).position.back();
}

double signal_rounding(const PlatoonModel& model, const Signal& signal, std::size_t followers, std::size_t steps) {
  constexpr double kOfPositions = 1e-11;
  const double period = model.sample_period;
  const auto weights = [](const Signal::Term& term) { return std::ldexp(std::abs(term.factor), term.order); };
  const double sum = signal.is_input ? weights({1.0 / (period * period), 2})
                                     : 2.0 * weights(signal.apart) + (signal.own.order > 0 ? weights(signal.own) : 0.0);
  return kOfPositions * sum * std::max(largest_positions(model, followers, steps).back(), 1.0);
}

namespace {

// The bounds for a platoon of the paper. `farthest`: the largest position up to each step [m].
std::vector<double> papers_rounding_bounds(const PlatoonModel& model, const std::vector<double>& farthest,
                                           const SignalMoments& moments) {
  const auto steps = static_cast<std::size_t>(moments.steps);
  const RoundingGains gains =
      rounding_gains(model.default_vehicle().loop.realization, model.default_vehicle().headway, steps);
  std::vector<double> unit_variance;
  if (model.default_vehicle().position().noise_variance == 0.0) {
    PlatoonModel noisy = model;
    noisy.default_vehicle().position().noise_variance = 1.0;
    noisy.default_vehicle().initial_position.variance = 0.0;
    noisy.recorded_leader.clear();
    unit_variance = error_moments(noisy, moments.followers, moments.steps).variance;
  }
  std::vector<double> bounds;
  bounds.reserve(moments.variance.size());
  for (std::size_t i = 1; i <= moments.followers; ++i) {
    for (std::size_t k = 0; k < steps; ++k) {
      const std::size_t c = (i - 1) * steps + k;
      const double unit = unit_variance.empty()
                              ? moments.variance[c] / model.default_vehicle().position().noise_variance
                              : unit_variance[c];
      const double ahead = 1.0 + std::sqrt(static_cast<double>(i) * static_cast<double>(k + 1) * unit);
      bounds.push_back(
          kRoundoff * farthest[k] *
          (4.0 * (1.0 + 2.0 * model.default_vehicle().headway) + gains.error[k] + ahead * gains.position[k]));
    }
  }
  return bounds;
}

// The largest bound among the paper's platoons of its vehicles, times the amplification by a predictor.
std::vector<double> linked_rounding_bounds(const PlatoonModel& model, const std::vector<double>& farthest,
                                           const SignalMoments& moments) {
  std::vector<double> largest(moments.variance.size(), 0.0);
  for (const VehicleModel& vehicle : pattern(model)) {
    PlatoonModel alike = model;
    alike.string.clear();
    alike.default_vehicle().inputs = {{InputSignal::position, alike.default_vehicle().position().noise_variance}};
    alike.default_vehicle().loop = vehicle.loop;
    alike.default_vehicle().headway = vehicle.headway;
    double predicted = 1.0;
    if (const std::optional<LossModel>& loss = vehicle.position().link.loss) {
      for (const double c : loss->predictor) predicted += std::abs(c);
    }
    const std::vector<double> bounds =
        papers_rounding_bounds(alike, farthest, error_moments(alike, moments.followers, moments.steps));
    for (std::size_t c = 0; c < bounds.size(); ++c) largest[c] = std::max(largest[c], predicted * bounds[c]);
  }
  return largest;
}

}  // namespace

std::vector<double> rounding_bounds(const PlatoonModel& model, const SignalMoments& moments) {
  const std::vector<double> farthest =
      largest_positions(model, moments.followers, static_cast<std::size_t>(moments.steps));
  return is_papers(model) ? papers_rounding_bounds(model, farthest, moments)
                          : linked_rounding_bounds(model, farthest, moments);
}

}  // namespace platoon
