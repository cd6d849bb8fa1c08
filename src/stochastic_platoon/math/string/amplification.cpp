#include "stochastic_platoon/math/string/amplification.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

constexpr double kClearSquare = 10.0;    ///< least ratio of a sum of squares to the noise subtracted from it
constexpr double kClearMaximum = 100.0;  ///< standard errors that a maximum must exceed

/// One vehicle's part of the rows.
struct VehicleRow {
  const SignalRows& rows;
  std::size_t first, end;  ///< cells

  double average(const std::vector<double>& values) const {
    double sum = 0.0;
    for (std::size_t c = first; c < end; ++c) sum += values[c];
    return sum / static_cast<double>(end - first);
  }
  double largest(const std::vector<double>& values) const {
    return *std::max_element(values.begin() + static_cast<std::ptrdiff_t>(first),
                             values.begin() + static_cast<std::ptrdiff_t>(end));
  }
};

// Root of the average of (mean - centre)^2 - variance_of_mean; none if noise hides the motion.
double root_mean_square(const VehicleRow& of, double centre) {
  double square = 0.0;
  for (std::size_t c = of.first; c < of.end; ++c)
    square += (of.rows.mean[c] - centre) * (of.rows.mean[c] - centre) - of.rows.variance_of_mean[c];
  square /= static_cast<double>(of.end - of.first);
  return square >= kClearSquare * of.average(of.rows.variance_of_mean) ? std::sqrt(square) : kNaN;
}

struct SpeedNorms {
  double l2 = kNaN, linf = kNaN;
};

SpeedNorms speed_norms(const VehicleRow& of) {
  const double centre = of.average(of.rows.mean);
  double linf = 0.0;
  for (std::size_t c = of.first; c < of.end; ++c) linf = std::max(linf, std::abs(of.rows.mean[c] - centre));
  if (std::isnan(centre)) return {};
  if (linf < kConstantSpeed) return {0.0, 0.0};
  const double standard_error = std::sqrt(of.largest(of.rows.variance_of_mean));
  return {root_mean_square(of, centre), linf >= kClearMaximum * standard_error ? linf : kNaN};
}

double root_mean_square_with_noise(const VehicleRow& of) {
  double square = 0.0;
  for (std::size_t c = of.first; c < of.end; ++c) square += of.rows.mean[c] * of.rows.mean[c] + of.rows.variance[c];
  return std::sqrt(square / static_cast<double>(of.end - of.first));
}

double ratio(double of, double to) {
  return of > 0.0 && to > 0.0 ? of / to : kNaN;
}

std::size_t vehicles_of(const SignalsByName& signals, std::int64_t steps, std::int64_t from) {
  if (from < 0 || from > steps - 2) {
    throw std::invalid_argument("from: " + std::to_string(from) +
                                ": must be from 0 to steps - 2 = " + std::to_string(steps - 2));
  }
  const auto length = static_cast<std::size_t>(steps);
  const std::size_t cells = signals.empty() ? 0 : signals.begin()->second.mean.size();
  for (const auto& [name, rows] : signals) {
    if (rows.mean.size() == cells && rows.variance.size() == cells && rows.variance_of_mean.size() == cells &&
        cells % length == 0)
      continue;
    throw std::invalid_argument(name + ": must have a mean, a variance and a variance of the mean for each of the " +
                                std::to_string(steps) + " steps of the same vehicles");
  }
  return cells / length;
}

}  // namespace

const std::vector<AmplificationFigure>& amplification_figures() {
  static const std::vector<AmplificationFigure> all = {{"l2_ratio", &Amplification::l2_ratio},
                                                       {"linf_ratio", &Amplification::linf_ratio},
                                                       {"l2_head_to_tail", &Amplification::l2_head_to_tail},
                                                       {"linf_head_to_tail", &Amplification::linf_head_to_tail},
                                                       {"rms_mean_speed", &Amplification::rms_mean_speed},
                                                       {"rms_acceleration", &Amplification::rms_acceleration},
                                                       {"rms_mean_acceleration", &Amplification::rms_mean_acceleration},
                                                       {"rms_jerk", &Amplification::rms_jerk},
                                                       {"rms_mean_jerk", &Amplification::rms_mean_jerk}};
  return all;
}

std::vector<double> leader_signal(const PlatoonModel& model, const std::string& name, std::int64_t steps) {
  const Signal signal = signals_of(model, {name}, 1).requested.front();
  LeaderVehicle leader(model);
  Signal::Recent<double> own;
  own.front() = leader.start();
  for (std::size_t j = 1; j < own.size(); ++j) own[j] = position_before(own.front(), j, start_slope(model));
  std::vector<double> values;
  for (std::int64_t k = 0; k < steps; ++k) {
    std::copy_backward(own.begin(), own.end() - 1, own.end());
    own.front() = leader.step();
    values.push_back(signal(own, own));
  }
  return values;
}

SignalRows with_leader(const PlatoonModel& model, const std::string& name, const SignalMoments& followers,
                       std::int64_t steps) {
  SignalRows rows{leader_signal(model, name, steps), std::vector<double>(static_cast<std::size_t>(steps), 0.0), {}};
  rows.mean.insert(rows.mean.end(), followers.mean.begin(), followers.mean.end());
  rows.variance.insert(rows.variance.end(), followers.variance.begin(), followers.variance.end());
  rows.variance_of_mean.assign(rows.mean.size(), 0.0);
  return rows;
}

std::vector<Amplification> amplification(const SignalsByName& signals, std::int64_t steps, std::int64_t from) {
  std::vector<Amplification> found(vehicles_of(signals, steps, from),
                                   {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
  const auto row = [&](const SignalRows& rows, std::size_t i) {
    const auto length = static_cast<std::size_t>(steps);
    return VehicleRow{rows, i * length + static_cast<std::size_t>(from), (i + 1) * length};
  };
  if (const auto speed = signals.find("speed"); speed != signals.end()) {
    std::vector<SpeedNorms> norms;
    for (std::size_t i = 0; i < found.size(); ++i) {
      norms.push_back(speed_norms(row(speed->second, i)));
      found[i].rms_mean_speed = norms[i].l2;
      if (i == 0) continue;
      found[i].l2_ratio = ratio(norms[i].l2, norms[i - 1].l2);
      found[i].linf_ratio = ratio(norms[i].linf, norms[i - 1].linf);
      found[i].l2_head_to_tail = ratio(norms[i].l2, norms[0].l2);
      found[i].linf_head_to_tail = ratio(norms[i].linf, norms[0].linf);
    }
  }
  const auto add = [&](const char* name, double Amplification::*with_noise, double Amplification::*of_mean) {
    const auto of = signals.find(name);
    if (of == signals.end()) return;
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i].*with_noise = root_mean_square_with_noise(row(of->second, i));
      found[i].*of_mean = root_mean_square(row(of->second, i), 0.0);
    }
  };
  add("acceleration", &Amplification::rms_acceleration, &Amplification::rms_mean_acceleration);
  add("jerk", &Amplification::rms_jerk, &Amplification::rms_mean_jerk);
  return found;
}

}  // namespace platoon
