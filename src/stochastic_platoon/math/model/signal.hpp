#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

enum class InputSignal;

/// A position `steps` steps before step -1, where it is `first` and grows by `slope` per step (start_slope()) [m].
inline double position_before(double first, std::size_t steps, double slope) {
  return steps == 0 || slope == 0.0 ? first : first - static_cast<double>(steps) * slope;
}

/// A quantity of follower i that is linear in its distance x_i = y_{i-1} - y_i from the predecessor and in its position
/// y_i, with the backward difference D y(k) = y(k) - y(k-1) and y_i(k) = position_before() for k < -1:
///
///     s_i(k) = apart.factor D^apart.order x_i(k) - offset + own.factor D^own.order y_i(k);
///
/// or the control input u_i(k-1), which leads to y_i(k).
struct Signal {
  /// factor D^order, order from 0 to kHighestOrder.
  struct Term {
    double factor = 0.0;
    int order = 0;
  };
  Term apart;             ///< factor 0: no such term
  double offset = 0.0;    ///< [m]; 0 without a term of the distance
  Term own = {};          ///< order 0: no such term
  bool is_input = false;  ///< the control input; all other members are 0

  static constexpr int kHighestOrder = 3;

  /// Whether the signal has a term of the distance.
  bool is_relative() const { return apart.factor != 0.0; }

  /// The factor of the distance x_i itself; 0 for its differences.
  double of_distance() const { return apart.order == 0 ? apart.factor : 0.0; }

  /// The value where both vehicles stand at this distance [m].
  double at_rest(double distance) const { return of_distance() * distance - offset; }

  /// The number of earlier positions that it needs.
  int order() const { return std::max(apart.order, own.order); }

  /// y(k), y(k-1), ..., y(k - order); later entries are not read.
  template <class T>
  using Recent = std::array<T, kHighestOrder + 1>;

  /// `ahead`, `behind`: positions of the predecessor and of the follower.
  double operator()(const Recent<double>& ahead, const Recent<double>& behind) const;

  /// The same for `count` realizations. Every pointer refers to `count` values [m]; the ranges do not overlap.
  void operator()(const Recent<const double*>& ahead, const Recent<const double*>& behind, std::size_t count,
                  double* values) const;
};

/// The positions from which the signals of one follower at one step follow, one per realization of a batch [m].
struct SignalPositions {
  Signal::Recent<const double*> ahead;  ///< y_{i-1}(k), y_{i-1}(k-1), ...; null for steps that no signal needs
  Signal::Recent<const double*> own;    ///< y_i(k), y_i(k-1), ...
  std::size_t count;                    ///< realizations
  const double* input = nullptr;        ///< u_i(k-1) [m/s^2]; null unless measures_input()

  /// The same from this realization on.
  SignalPositions from(std::size_t realization) const;

  /// The values of a signal.
  void form(const Signal& signal, double* values) const;
  std::vector<double> of(const Signal& signal) const;
};

/// What an input with is_difference() carries: D y / T_s [m/s] or D^2 y / T_s^2 [m/s^2].
Signal difference(InputSignal signal, double sample_period);

/// The tracking error [m] of follower i >= 1, paper eq. (error1), including its distance delta:
/// \f[ \zeta_i(k) = y_{i-1}(k) - y_i(k) - \delta - h [y_i(k) - y_i(k-1)]. \f]
Signal tracking_error(const PlatoonModel& model, std::size_t follower);

/// A signal that a run computes on request.
struct SignalKind {
  const char* name;
  const char* unit;
  Signal (*of)(const PlatoonModel& model, std::size_t follower);  ///< of follower i >= 1
};

/// Name of the signal g_i(k) = y_{i-1}(k) - y_i(k) - (length of vehicle i-1), whose smallest values are collected too.
constexpr char kGap[] = "gap";

/// Name of the control input that leads to the position of a step, u_i(k-1), of vehicles computed part by part.
constexpr char kInput[] = "input";
/// Their condition, in an error.
constexpr char kWithInput[] = "every vehicle has limits, a radio, or a plant by its actuator_lag or continuous";

/// Whether a run with these signals measures the control input of a follower: on request, or because it is limited.
bool measures_input(const PlatoonModel& model, const std::vector<std::string>& signals, std::size_t follower);

/// All signals on request: gap [m], speed D y_i / T_s [m/s], acceleration D^2 y_i / T_s^2, jerk D^3 y_i / T_s^3, the
/// control input [m/s^2], and the relative speed D (y_{i-1} - y_i) / T_s [m/s], at which the gap grows.
const std::vector<SignalKind>& signal_kinds();

/// The unit of the signal of this name. Throws std::invalid_argument for an unknown name.
const char* unit_of(const std::string& name);

/// The name in a sentence, as "relative speed".
std::string in_words(std::string name);

/// The names in a list separated by commas, in the order of signal_kinds(); an empty text gives none. Throws
/// std::invalid_argument unless each is a signal and given once.
std::vector<std::string> signal_names(const std::string& text);

/// The allowed names, for messages: "gap, speed, acceleration, jerk, input, relative_speed".
std::string all_signal_names();

/// The signals of one follower that a run computes.
struct FollowerSignals {
  Signal error;                   ///< the tracking error
  std::vector<Signal> requested;  ///< those on request
};

/// The tracking error of follower i >= 1 and the signals of these names, in their order. Throws std::invalid_argument
/// for an unknown name.
FollowerSignals signals_of(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t follower);

/// Signals of successive followers: of each the same number.
using SignalLists = std::vector<std::vector<Signal>>;

/// The requested signals of so many followers from `first` on; without names the tracking errors alone.
SignalLists signal_lists(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t followers,
                         std::size_t first = 1);

/// signals_of() followers 1, 2, ..., `followers`.
std::vector<FollowerSignals> signals_of_all(const PlatoonModel& model, const std::vector<std::string>& names,
                                            std::size_t followers);

/// Number of earlier positions that these signals need; at least 1.
std::size_t steps_before(const FollowerSignals& signals);

}  // namespace platoon
