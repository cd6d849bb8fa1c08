#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/model/leader_profile.hpp"
#include "stochastic_platoon/math/model/vehicle_model.hpp"

namespace platoon {

/// Parameters that a vehicle type takes from the default vehicle, including later changes of them.
struct Inherited {
  bool headway = false;
  bool plant = false;
  bool controller = false;
  bool loss_probability = false;  ///< of VehicleModel::varied_link()
  bool mean_burst = false;        ///< of the same
  bool inputs = false;            ///< whom it hears, and over which links
  bool noise_variance = false;    ///< of the position, with the inputs
  bool channel = false;           ///< of the position, with the inputs
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
      : types{{"default", std::move(vehicle), {true, true, true, true, true, true, true, true}}},
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
/// default vehicle and of all types that inherit it in the model file. Losses keep their mean bursts. These functions
/// throw std::invalid_argument if a closed loop was given, which fits one headway only, or if there is no loss.
PlatoonModel with_headway(PlatoonModel model, double headway);
PlatoonModel with_gain(PlatoonModel model, double gain);
PlatoonModel with_loss(PlatoonModel model, double probability);
PlatoonModel with_mean_burst(PlatoonModel model, double mean_burst);

/// If the default vehicle's varied_link() has no loss stage, adds one that holds the last value: to it, and to the
/// types that inherit its inputs and have no losses of their own there, as a model file does whose default vehicle is
/// given a loss probability.
PlatoonModel with_loss_stage(PlatoonModel model);

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

/// The number d_i of steps for each follower i such that y_0(k - d_i) is the latest position of the leader on which
/// zeta_i(k) depends: i - 1 if all vehicles hear their predecessors, less if a vehicle hears farther ahead.
std::vector<std::int64_t> steps_from_leader(const PlatoonModel& model, std::size_t followers);

/// Whether the platoon is the paper's: homogeneous, over channels that only add white noise.
bool is_papers(const PlatoonModel& model);

/// Whether a follower of the string has a radio. Then all vehicles are computed part by part.
bool has_radios(const PlatoonModel& model);

/// Whether vehicle `sender`, 0 .. followers - 1, has a follower that receives its input, directly ahead or not.
bool sends_input(const PlatoonModel& model, std::size_t sender, std::size_t followers);

/// Whether a link of the string loses messages; whether one does so by the gap.
bool loses(const PlatoonModel& model);
bool depends_on_gap(const PlatoonModel& model);

/// Whether all errors are normal, which losses, quantisation and limits prevent.
bool has_normal_errors(const PlatoonModel& model);

/// Throws std::invalid_argument unless has_normal_errors(model).
void require_normal_errors(const PlatoonModel& model);

/// Whether a vehicle type has limits. Then vehicle 0 is moved exactly.
bool has_limits(const PlatoonModel& model);

/// Whether vehicle 0 is moved along given positions: its drive was recorded, a vehicle has limits, or one hears others
/// than its predecessor. Otherwise it follows a virtual leader through its closed loop.
bool moves_leader(const PlatoonModel& model);

/// Duration of a number of steps, with its unit: "9.9 s"; "9.9 s (99 steps)"; "9.9 s (step 99)"; a frequency w
/// [rad/sample] as "11.6 rad/s (1.16 rad/sample)".
std::string duration(std::int64_t steps, const PlatoonModel& model);
std::string duration_in_steps(std::int64_t steps, const PlatoonModel& model);
std::string time_of_step(std::int64_t step, const PlatoonModel& model);
std::string frequency_text(double w, double sample_period);

}  // namespace platoon
