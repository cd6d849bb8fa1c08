#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

/// A quantity of follower i that is linear in its position y_i and in that of its predecessor, with the backward
/// difference D y(k) = y(k) - y(k-1) and y_i(k) = y_i(-1) for k < -1:
///
///     s_i(k) = [y_{i-1}(k) - y_i(k) - offset] + factor D^order y_i(k),   the bracket only if the signal is relative.
struct Signal {
  bool relative;
  double offset;  ///< [m]
  int order;      ///< 0 (no such term) to kHighestOrder
  double factor;

  static constexpr int kHighestOrder = 3;

  /// y_i(k), y_i(k-1), ..., y_i(k - order); later entries are not read.
  template <class T>
  using Own = std::array<T, kHighestOrder + 1>;

  double operator()(double predecessor, const Own<double>& own) const;

  /// The same for `count` realizations. Every pointer refers to `count` values [m]; the ranges do not overlap.
  void operator()(const double* predecessor, const Own<const double*>& own, std::size_t count, double* values) const;
};

/// The positions from which the signals of one follower at one step follow, one per realization of a batch [m].
struct SignalPositions {
  const double* predecessor;       ///< y_{i-1}(k)
  Signal::Own<const double*> own;  ///< y_i(k), y_i(k-1), ...; null for steps that no signal needs
  std::size_t count;               ///< realizations

  /// The same from this realization on.
  SignalPositions from(std::size_t realization) const;

  std::vector<double> of(const Signal& signal) const;
};

/// The tracking error [m], paper eq. (error1), including the distance delta:
/// \f[ \zeta_i(k) = y_{i-1}(k) - y_i(k) - \delta - h [y_i(k) - y_i(k-1)]. \f]
Signal tracking_error(double headway, double standstill_distance);

/// The same for follower i >= 1, with its own headway and distance.
Signal tracking_error(const PlatoonModel& model, std::size_t follower);

/// A signal that a run computes on request.
struct SignalKind {
  const char* name;
  const char* unit;
  Signal (*of)(const PlatoonModel& model, std::size_t follower);  ///< of follower i >= 1
};

/// Name of the signal g_i(k) = y_{i-1}(k) - y_i(k) - (length of vehicle i-1), whose smallest values are collected too.
constexpr char kGap[] = "gap";

/// All signals on request: gap [m], speed D y_i / T_s [m/s], acceleration D^2 y_i / T_s^2, jerk D^3 y_i / T_s^3.
const std::vector<SignalKind>& signal_kinds();

/// The unit of the signal of this name. Throws std::invalid_argument for an unknown name.
const char* unit_of(const std::string& name);

/// The names in a list separated by commas, in the order of signal_kinds(); an empty text gives none. Throws
/// std::invalid_argument unless each is a signal and given once.
std::vector<std::string> signal_names(const std::string& text);

/// The allowed names, for messages: "gap, speed, acceleration, jerk".
std::string all_signal_names();

/// The signals of one follower that a run computes.
struct FollowerSignals {
  Signal error;                   ///< the tracking error
  std::vector<Signal> requested;  ///< those on request
};

/// The tracking error of follower i >= 1 and the signals of these names, in their order. Throws std::invalid_argument
/// for an unknown name.
FollowerSignals signals_of(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t follower);

/// The same of followers 1, 2, ..., `followers`.
std::vector<FollowerSignals> signals_of_all(const PlatoonModel& model, const std::vector<std::string>& names,
                                            std::size_t followers);

/// Number of earlier own positions that these signals need; at least 1.
std::size_t steps_before(const FollowerSignals& signals);

}  // namespace platoon
