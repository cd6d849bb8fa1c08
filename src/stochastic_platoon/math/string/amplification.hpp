#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"

namespace platoon {

/// Moments of one signal of vehicles 0 .. N at steps 0 .. steps - 1; the index of vehicle i at step k is i steps + k.
struct SignalRows {
  std::vector<double> mean;
  std::vector<double> variance;          ///< the mean square is mean^2 + variance
  std::vector<double> variance_of_mean;  ///< squared standard error of a measured mean; 0 of an exact one
};

/// The speeds, accelerations and jerks of all vehicles, by the names of signal_kinds().
using SignalsByName = std::map<std::string, SignalRows>;

/// Motion of one vehicle from a step on, and its ratio to that of vehicles ahead. NaN: see amplification().
struct Amplification {
  double l2_ratio, linf_ratio;                     ///< to the predecessor; NaN for the leader
  double l2_head_to_tail, linf_head_to_tail;       ///< to the leader; NaN for the leader
  double rms_mean_speed;                           ///< [m/s], about its average; 0 of a constant speed
  double rms_acceleration, rms_mean_acceleration;  ///< [m/s^2]
  double rms_jerk, rms_mean_jerk;                  ///< [m/s^3]
};

/// The figures with their names in files.
struct AmplificationFigure {
  const char* name;
  double Amplification::*value;
};
const std::vector<AmplificationFigure>& amplification_figures();

/// Speeds that differ from their average by less than this at every step are constant: positions in double do not
/// resolve less [m/s].
constexpr double kConstantSpeed = 1e-6;

/// The leader's signal of this name, steps 0 .. steps - 1: differences of the positions of LeaderVehicle.
std::vector<double> leader_signal(const PlatoonModel& model, const std::string& name, std::int64_t steps);

/// The leader's exact signal, then the followers' exact moments.
SignalRows with_leader(const PlatoonModel& model, const std::string& name, const SignalMoments& followers,
                       std::int64_t steps);

/// Amplification of the speeds along the string, one entry per vehicle 0 .. N, over the steps k = from .. steps - 1.
/// With m_i(k) the mean speed of vehicle i less its average over these steps, and v_i(k) its variance_of_mean, the
/// members l2_ratio and linf_ratio are
/// \f[ \frac{\|m_i\|_2}{\|m_{i-1}\|_2}, \qquad \|m_i\|_2^2 = \sum_k (m_i(k)^2 - v_i(k)), \f]
/// \f[ \frac{\|m_i\|_\infty}{\|m_{i-1}\|_\infty}, \qquad \|m_i\|_\infty = \max_k |m_i(k)|, \f]
/// and head to tail the same with vehicle 0 in place of i-1. Further
///
///     rms_mean_speed           ||m_i||_2 / sqrt(steps - from)
///     rms_acceleration^2       average over k of mean^2 + variance of the acceleration, noise included
///     rms_mean_acceleration^2  average over k of mean^2 - variance_of_mean, of the mean motion alone
///
/// and the same for the jerk. The noise of measured means adds variance_of_mean to every expected square, so it is
/// subtracted. Behind a sinusoidal leader l2_ratio is |T(e^jw)| over whole periods after the transient. If the speed
/// ends at another level than it began, the delay of the followers moves their averages, and a ratio may exceed the
/// largest |T|: that of follower 1 is 1.007 at h = 3.2 if the speed drops after 50 of 150 steps.
///
/// NaN: a ratio of a constant speed (see kConstantSpeed); a figure whose signal is not given; and a figure that noise
/// hides: a sum of squares below ten times the sum of variance_of_mean subtracted from it, a maximum below 100 standard
/// errors.
///
/// Throws std::invalid_argument unless 0 <= from <= steps - 2 and all rows have the same size, a multiple of steps.
std::vector<Amplification> amplification(const SignalsByName& signals, std::int64_t steps, std::int64_t from);

}  // namespace platoon
