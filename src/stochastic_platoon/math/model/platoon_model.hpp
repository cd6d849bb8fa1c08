#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/model/leader_profile.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/model/vehicle_limits.hpp"

namespace platoon {

/// Initial position of follower i: -i delta plus N(mean, variance), independent per follower and realization.
struct InitialPosition {
  double mean = 0.0;      ///< [m]
  double variance = 0.0;  ///< [m^2], >= 0
};

/// What an input of a follower carries: the position y of its source, the differences D y / T_s and D^2 y / T_s^2, or
/// the control input u.
enum class InputSignal { position, speed, acceleration, input };

/// What a follower i receives from a vehicle ahead, over a link of its own. With s(j) the source of input j, d_j = i -
/// s(j), r_j the received value, D y(k) = y(k) - y(k-1), and H = (1 + h) - h / z if the vehicle has a headway filter, 1
/// otherwise,
/// \f[ H u_i = K \sum_{positions} w_j (r_j - y_i - d_j h D y_i - d_j \delta) + \sum_{speeds} F_j (r_j - D y_i / T_s)
///           + \sum_{accelerations, inputs} F_j r_j + F_a D^2 y_i / T_s^2, \qquad y_i = G u_i, \f]
/// where the weights w_j sum to 1 and F_a is VehicleModel::own_acceleration. The input of step k is known one step
/// after the position of step k, so its delay is m >= 1: v(k) = u(k-1) is sent with the position of step k, and the
/// link delays it by m - 1 steps.
struct Input {
  InputSignal signal = InputSignal::position;
  double noise_variance = 0.0;  ///< >= 0, P_d of positions [m^2], else in the squared unit of the signal
  double gain = 1.0;            ///< w or F
  LinkModel link = {};          ///< its delay is m
  std::size_t ahead = 1;        ///< the source is this many vehicles ahead, at most vehicle 0; kLeader: vehicle 0
  std::string packet = {};      ///< inputs of a vehicle with the same name are lost together; empty: alone

  static constexpr std::size_t kLeader = 0;

  /// Steps between sending and arrival.
  std::int64_t delay() const { return signal == InputSignal::input ? link.delay - 1 : link.delay; }
};

bool operator==(const Input& one, const Input& other);

/// As in model files: "position", "speed", "acceleration", "input".
const char* name_of(InputSignal signal);

/// The vehicle that an input of a follower comes from.
std::size_t source_of(const Input& input, std::size_t follower);

/// Per-follower part of the model: the vehicle, its spacing and what it receives.
struct VehicleModel {
  ClosedLoop loop;
  double headway;                         ///< h > 0, in sample periods; 0 with constant_spacing
  double standstill_distance = 0.0;       ///< delta >= 0 [m], to its predecessor
  std::vector<Input> inputs = {Input()};  ///< the position, and with a radio the control input of the predecessor
  InitialPosition initial_position = {};
  std::optional<LoopDesign> design = {};  ///< none if the closed loop itself was given
  double length = 0.0;                    ///< >= 0 [m]; y is the position of the front
  VehicleLimits limits = {};              ///< of vehicles with a design only
  bool constant_spacing = false;          ///< h = 0
  double own_acceleration = 0.0;          ///< F_a, see Input

  /// Whether the vehicle hears its predecessor alone, as all formulas without Input::ahead assume: one position, behind
  /// it one control input or none, and a headway.
  bool hears_predecessor_only() const;

  /// The first position among the inputs.
  const Input& position() const;
  Input& position() { return const_cast<Input&>(const_cast<const VehicleModel*>(this)->position()); }
  const Input* radio() const { return inputs.size() > 1 ? &inputs.back() : nullptr; }  ///< null: none
  Input* radio() { return inputs.size() > 1 ? &inputs.back() : nullptr; }

  /// The input whose losses input n shares: the first of its packet, else itself.
  std::size_t losses_of(std::size_t n) const;

  /// The inputs whose losses with_loss() varies, which are lost together: the radio if there is one, else the position;
  /// of a vehicle that hears others than its predecessor the last input that loses, else the last, with those of its
  /// packet.
  std::vector<std::size_t> varied_inputs() const;
  const LinkModel& varied_link() const { return inputs[varied_inputs().front()].link; }

  /// Calls change(link) with the link of each of them.
  template <class Change>
  void vary(const Change& change) {
    for (const std::size_t n : varied_inputs()) change(inputs[n].link);
  }
};

/// Parameters that a vehicle type takes from the default vehicle, including later changes of them.
struct Inherited {
  bool headway = false;
  bool plant = false;
  bool controller = false;
  bool loss_probability = false;  ///< of VehicleModel::varied_link()
  bool mean_burst = false;        ///< of the same
};

/// A vehicle type and its name in the model file.
struct VehicleType {
  std::string name;
  VehicleModel vehicle;
  Inherited inherited = {};
};

/// How the platoon begins at step -1.
enum class Start {
  rest,   ///< every vehicle stands at its place
  steady  ///< all states, registers and delay lines as behind a leader that has always driven at its first speed
};

/// Everything the mathematics of a platoon needs (paper, section 3): the contents of the model file. The platoon is
/// homogeneous if all its followers have the default type; if the link is also the default one, it is the paper's.
///
/// A plain value: each class that uses a part of it checks that part (LoopBatch, AwgnChannel, FollowerVehicle,
/// LeaderVehicle throw std::invalid_argument), and the parser of the model file checks all of it.
struct PlatoonModel {
  /// One type, named default.
  PlatoonModel(VehicleModel vehicle, LeaderProfile profile, double period = 0.1)
      : types{{"default", std::move(vehicle), {true, true, true, true, true}}},
        sample_period(period),
        leader(std::move(profile)) {}

  std::vector<VehicleType> types;  ///< [0] is the default type, which is also the leader's
  /// Types of followers 1, 2, ..., repeated. Empty: all have the default type.
  std::vector<std::size_t> string;
  double sample_period;  ///< T_s > 0 [s]
  LeaderProfile leader;
  /// y_0(-1), y_0(0), ... [m]: recorded positions of vehicle 0, used instead of the loop behind `leader`. Empty: none.
  std::vector<double> recorded_leader;
  bool allow_unstable = false;          ///< whether rho(A) >= 1 is accepted
  std::optional<double> safe_gap = {};  ///< >= 0 [m]: realizations with a smaller gap are counted
  std::optional<Start> start = {};      ///< none: steady if a vehicle has limits, else at rest

  const VehicleModel& default_vehicle() const { return types.front().vehicle; }
  VehicleModel& default_vehicle() { return types.front().vehicle; }
};

/// Follower i >= 1 of the platoon; for i = 0 the leader, which has the default type.
const VehicleModel& vehicle(const PlatoonModel& model, std::size_t follower);

/// Types of one repetition of the string, as indices of PlatoonModel::types.
std::vector<std::size_t> type_order(const PlatoonModel& model);

/// Names of the types in the string that have the given parameter of the default vehicle, the default type included.
std::vector<std::string> types_with_default(const PlatoonModel& model, bool Inherited::*inherited);

/// The platoon with another headway, controller gain (leading coefficient of the numerator) or loss probability of the
/// default vehicle and of all types that inherit it in the model file. Losses become independent, as a mean burst
/// belongs to one probability; with_mean_burst() sets it again. These functions throw std::invalid_argument if a closed
/// loop was given, which fits one headway only, or if there is no loss.
PlatoonModel with_headway(PlatoonModel model, double headway);
PlatoonModel with_gain(PlatoonModel model, double gain);
PlatoonModel with_loss(PlatoonModel model, double probability);
PlatoonModel with_mean_burst(PlatoonModel model, double mean_burst);

/// Whether a link of the string satisfies a condition.
bool any_link(const PlatoonModel& model, const std::function<bool(const LinkModel&)>& condition);

/// The vehicles of one repetition of the string.
std::vector<VehicleModel> pattern(const PlatoonModel& model);

/// Whether all followers have the type `default`.
bool is_homogeneous(const PlatoonModel& model);

/// Whether every follower of the string hears its predecessor alone.
bool hears_predecessors_only(const PlatoonModel& model);

/// The farthest vehicle ahead that a follower of the string hears, apart from the leader by name; at least 1.
std::size_t farthest_ahead(const PlatoonModel& model);

/// The sum of w_j d_j of a follower (see Input): its distance, in vehicles, that its headway and delta multiply. 1 if
/// it hears its predecessor alone.
double spacing_in_vehicles(const VehicleModel& vehicle, std::size_t follower);

/// The sum of F_j / T_s over the speeds that a vehicle hears, the gain of its own D y (see Input) [1/s^2].
double own_speed_gain(const VehicleModel& vehicle, double sample_period);

/// Places of vehicles 0 .. followers in steady motion by `slope` per step, where no vehicle has a spacing error [m]:
/// that of i is the sum of w_j (y_s(j) - late_j) minus that of w_j d_j (slope h + delta). `late` [m] is what the
/// received position lags behind; of any other input, by how much it holds the vehicle back.
std::vector<double> steady_places(const PlatoonModel& model, std::size_t followers, double slope,
                                  const std::function<double(const VehicleModel& own, const Input& input)>& late);

/// Whether the platoon is the paper's: homogeneous, over channels that only add white noise.
bool is_papers(const PlatoonModel& model);

/// Whether a follower of the string has a radio. Then all vehicles are computed part by part.
bool has_radios(const PlatoonModel& model);

/// Whether vehicle `sender`, 0 .. followers - 1, has a follower that receives its input, directly ahead or not.
bool sends_input(const PlatoonModel& model, std::size_t sender, std::size_t followers);

/// Whether the losses of a link of the string depend on the gap.
bool depends_on_gap(const PlatoonModel& model);

/// Whether all errors are normal, which losses, quantisation and limits prevent.
bool has_normal_errors(const PlatoonModel& model);

/// Whether a vehicle type has limits. Then vehicle 0 is moved exactly.
bool has_limits(const PlatoonModel& model);

/// Whether vehicle 0 is moved along given positions: its drive was recorded, a vehicle has limits, or one hears others
/// than its predecessor. Otherwise it follows a virtual leader through its closed loop.
bool moves_leader(const PlatoonModel& model);

/// Whether the platoon starts in steady motion.
bool starts_steady(const PlatoonModel& model);

/// Displacement of all vehicles per step before step -1: y_0(0) - y_0(-1) = V T_s for a steady start, 0 at rest [m].
double start_slope(const PlatoonModel& model);

/// Mean position of follower i at step -1, without the mean of its InitialPosition: its place in formation, and behind
/// it in steady motion by the headways and the delays of the links up to it [m].
double start_place(const PlatoonModel& model, std::size_t follower);

/// Duration of a number of steps, with its unit: "9.9 s"; "9.9 s (99 steps)"; "9.9 s (step 99)"; a frequency w
/// [rad/sample] as "11.6 rad/s (1.16 rad/sample)".
std::string duration(std::int64_t steps, const PlatoonModel& model);
std::string duration_in_steps(std::int64_t steps, const PlatoonModel& model);
std::string time_of_step(std::int64_t step, const PlatoonModel& model);
std::string frequency_text(double w, double sample_period);

/// Place of follower i in formation: -(delta_1 + ... + delta_i) [m].
double place_in_formation(const PlatoonModel& model, std::size_t follower);

}  // namespace platoon
