#include "stochastic_platoon/run/report/plausibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/loop_assumptions.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

constexpr double kShortestHeadway = 0.05, kLongestHeadway = 10.0;  // [s]
constexpr double kOneInAHundred = 2.58;                            // standard deviations, both tails
constexpr std::size_t kMostTheory = 100'000;                       // of the theory that is computed for warnings
constexpr std::size_t kMostLossyTheory = 2'000;                    // the same where links lose
constexpr std::array<const char*, 2> kMotion{"speed", "acceleration"};
constexpr double kShareOfTime = 0.003;  // of half a minute, of chain_moments()

/// The speeds that the leader is given, and the accelerations of a recorded drive.
struct LeaderMotion {
  Interval speed{kInfinity, -kInfinity}, acceleration{kInfinity, -kInfinity};

  explicit LeaderMotion(const PlatoonModel& model) {
    const auto take = [](Interval& range, double value) {
      range = {std::min(range.lower, value), std::max(range.upper, value)};
    };
    const std::vector<double>& recorded = model.recorded_leader;
    const double period = model.sample_period;
    for (std::size_t k = 1; k < recorded.size(); ++k) {
      take(speed, (recorded[k] - recorded[k - 1]) / period);
      if (k > 1) take(acceleration, (recorded[k] - 2.0 * recorded[k - 1] + recorded[k - 2]) / (period * period));
    }
    if (!recorded.empty()) return;
    for (const SpeedChange& change : model.leader.changes()) take(speed, change.value);
  }
};

void add_leader(const PlatoonModel& model, std::vector<std::string>& warnings) {
  constexpr double kRounding = 1e-6;
  const LeaderMotion leader(model);
  const VehicleLimits& limits = vehicle(model, 0).limits;
  const auto add_beyond = [&warnings](const char* what, const Interval& motion, const std::optional<Interval>& limit,
                                      const char* unit) {
    if (!limit || (motion.lower >= limit->lower - kRounding && motion.upper <= limit->upper + kRounding)) return false;
    warnings.push_back(formatted("leader: %s from %.6g to %.6g %s: beyond the limits of the vehicle, %g to %g %s", what,
                                 motion.lower, motion.upper, unit, limit->lower, limit->upper, unit));
    return true;
  };
  const double fastest = std::max(-leader.speed.lower, leader.speed.upper);
  if (fastest > kFastestCar)
    warnings.push_back(
        formatted("leader: speed of %.6g m/s (%.6g km/h): cars reach %g m/s", fastest, 3.6 * fastest, kFastestCar));
  if (!add_beyond("speed", leader.speed, limits.speed, "m/s") && leader.speed.lower < kReversing)
    warnings.push_back(formatted("leader: speed of %.6g m/s: the car reverses", leader.speed.lower));
  add_beyond("acceleration", leader.acceleration, limits.input, "m/s^2");
}

/// The largest -v or |a| that a vehicle's limits leave possible; infinite without limits. A clipped signal is not
/// normal: its mean and deviation alone would say that cars reverse which cannot.
double most_possible(const VehicleLimits& limits, bool is_speed) {
  if (is_speed) return limits.speed ? -limits.speed->lower : kInfinity;
  return limits.input ? std::max(-limits.input->lower, limits.input->upper) : kInfinity;
}

std::string of_type(const PlatoonModel& model, std::size_t type) {
  return is_homogeneous(model) ? "" : " of " + model.types[type].name;
}

/// The types in the string, each once.
std::vector<std::size_t> types_of(const PlatoonModel& model) {
  std::vector<std::size_t> types = type_order(model);
  std::sort(types.begin(), types.end());
  types.erase(std::unique(types.begin(), types.end()), types.end());
  return types;
}

void add_cancelled_modes(const PlatoonModel& model, std::vector<std::string>& warnings) {
  for (const std::size_t type : types_of(model)) {
    for (const std::string& mode : cancelled_unstable_modes(model.types[type].vehicle.loop))
      warnings.push_back("G(z) K(z)" + of_type(model, type) + " cancels an unstable mode at " + mode +
                         ", which allow_unstable admits: it grows in a real car, and no figure contains it");
  }
}

void add_headways(const PlatoonModel& model, std::vector<std::string>& warnings) {
  for (const std::size_t type : types_of(model)) {
    const double headway = model.types[type].vehicle.headway, seconds = headway * model.sample_period;
    const bool is_usual = seconds >= kShortestHeadway && seconds <= kLongestHeadway;
    if (is_usual || model.types[type].vehicle.constant_spacing) continue;
    warnings.push_back(formatted("time_headway%s: %.6g s (%.6g sample periods of %g s): cars keep %g s to %g s",
                                 of_type(model, type).c_str(), seconds, headway, model.sample_period, kShortestHeadway,
                                 kLongestHeadway));
  }
}

void add_drive(const Configuration& configuration, std::vector<std::string>& warnings) {
  const PlatoonModel& model = configuration.model;
  const std::int64_t steps = configuration.run.steps, all = static_cast<std::int64_t>(model.recorded_leader.size()) - 1;
  if (!configuration.run.steps_chosen || steps >= all) return;
  warnings.push_back(formatted("leader: the run ends at %.6g s of a drive of %.6g s: steps %lld run all of it",
                               static_cast<double>(steps) * model.sample_period,
                               static_cast<double>(all) * model.sample_period, static_cast<long long>(all)));
}

void add_standstill(const PlatoonModel& model, std::size_t followers, std::vector<std::string>& warnings) {
  const std::size_t first = std::min(followers, type_order(model).size() + 1);
  for (std::size_t i = 1; i <= first; ++i) {
    const double distance = vehicle(model, i).standstill_distance, length = vehicle(model, i - 1).length;
    if (distance >= length) continue;
    warnings.push_back(formatted(
        "standstill_distance: %g m of follower %zu: below the %g m of vehicle_length ahead of it: standing cars overlap",
        distance, i, length));
    return;
  }
}

}  // namespace

std::vector<std::string> motion_warnings(const PlatoonModel& model, const std::vector<SignalFigures>& signals,
                                         std::int64_t steps) {
  std::vector<std::string> warnings;
  const auto width = static_cast<std::size_t>(steps);
  for (const SignalFigures& signal : signals) {
    const bool is_speed = signal.name == "speed";
    if (!is_speed && signal.name != "acceleration") continue;
    const double allowed = is_speed ? -kReversing : kHardest;
    std::size_t worst = 0;
    double largest = allowed;
    for (std::size_t c = 0; c < signal.mean.size(); ++c) {
      const double mean = is_speed ? -signal.mean[c] : std::abs(signal.mean[c]);
      const double reached = std::min(mean + kOneInAHundred * std::sqrt(signal.variance[c]),
                                      most_possible(vehicle(model, c / width + 1).limits, is_speed));
      if (!(reached > largest)) continue;
      largest = reached;
      worst = c;
    }
    if (!(largest > allowed)) continue;
    const auto step = static_cast<std::int64_t>(worst % width);
    const std::string where = formatted("follower %zu at %s", worst / width + 1, time_of_step(step, model).c_str());
    warnings.push_back(
        is_speed ? formatted("speed: mean - 2.58 sigma = %.3g m/s, of %s: the car reverses", -largest, where.c_str())
                 : formatted("acceleration: |mean| + 2.58 sigma = %.3g m/s^2, of %s: cars reach %g m/s^2", largest,
                             where.c_str(), kHardest));
  }
  return warnings;
}

std::string warning_lines(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text += "Warning: " + warning + "\n";
  return text;
}

std::vector<std::string> with_motion(std::vector<std::string> names, const RunOptions& run) {
  if (run.followers * static_cast<std::size_t>(std::max<std::int64_t>(run.steps, 0)) > kMostTheory) return names;
  for (const char* name : kMotion) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.emplace_back(name);
  }
  return names;
}

std::vector<SignalFigures> signal_figures(const std::vector<std::string>& names,
                                          const std::vector<SignalMoments>& signals, std::size_t followers,
                                          std::int64_t steps) {
  const auto cells = static_cast<std::ptrdiff_t>(followers * static_cast<std::size_t>(steps));
  std::vector<SignalFigures> figures;
  for (std::size_t s = 0; s < signals.size(); ++s) {
    const SignalMoments& of = signals[s];
    figures.push_back(
        {names[s], {of.mean.begin(), of.mean.begin() + cells}, {of.variance.begin(), of.variance.begin() + cells}});
  }
  return figures;
}

std::vector<std::string> plausibility_warnings(const Configuration& configuration,
                                               const std::vector<SignalFigures>& known) {
  const PlatoonModel& model = configuration.model;
  const RunOptions& run = configuration.run;
  std::vector<std::string> warnings;
  add_leader(model, warnings);
  add_drive(configuration, warnings);
  add_cancelled_modes(model, warnings);
  add_headways(model, warnings);
  add_standstill(model, run.followers, warnings);
  if (no_theory(model) || run.followers_before_external() == 0) return warnings;
  const auto add_motion = [&](const std::vector<SignalFigures>& figures, std::int64_t steps) {
    const std::vector<std::string> motion = motion_warnings(model, figures, steps);
    warnings.insert(warnings.end(), motion.begin(), motion.end());
  };
  add_motion(known, run.steps);
  std::vector<std::string> names(kMotion.begin(), kMotion.end());
  for (const SignalFigures& of : known) names.erase(std::remove(names.begin(), names.end(), of.name), names.end());
  if (names.empty()) return warnings;
  const auto usual = static_cast<std::int64_t>(std::clamp(10.0 / model.sample_period, 100.0, 10000.0));
  const auto recorded = static_cast<std::int64_t>(model.recorded_leader.size());  // of one step more
  const std::int64_t most = recorded > 1 ? recorded - 1 : static_cast<std::int64_t>(kMostTheory);
  std::int64_t steps = std::min(run.steps > 0 ? run.steps : usual, most);
  const std::size_t most_theory = loses(model) ? kMostLossyTheory : kMostTheory;
  const std::size_t followers = std::min(run.followers_before_external(),
                                         std::max<std::size_t>(most_theory / static_cast<std::size_t>(steps), 1));
  if (needs_chain_moments(model))
    steps = std::clamp<std::int64_t>(most_chain_steps(model, followers, kShareOfTime), 1, steps);
  try {
    add_motion(signal_figures(names, signal_moments(model, names, followers, steps), followers, steps), steps);
  } catch (const std::invalid_argument&) {
    // A loop without an equilibrium has no theory of signals.
  }
  return warnings;
}

}  // namespace platoon
