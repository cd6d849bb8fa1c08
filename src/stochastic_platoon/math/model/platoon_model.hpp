#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/model/leader_profile.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"

namespace platoon {

/// Initial position of follower i: -i delta plus N(mean, variance), independent per follower and realization.
struct InitialPosition {
  double mean = 0.0;      ///< [m]
  double variance = 0.0;  ///< [m^2], >= 0
};

/// What may differ from follower to follower: the vehicle, its spacing and the link into it.
struct VehicleModel {
  ClosedLoop loop;
  double headway;              ///< h > 0, in sample periods
  double standstill_distance;  ///< delta >= 0 [m], to its predecessor
  double noise_variance;       ///< P_d >= 0 [m^2]
  InitialPosition initial_position;
  std::optional<LoopDesign> design;  ///< none where the closed loop itself was given
  LinkModel link;
};

/// What a type of vehicle does not give: it follows the default vehicle's, also where that is changed.
struct Inherited {
  bool headway = false;
  bool plant = false;
  bool controller = false;
  bool loss_probability = false;
};

/// A type of vehicle, by its name in the model file.
struct VehicleType {
  std::string name;
  VehicleModel vehicle;
  Inherited inherited = {};
};

/// Everything the mathematics of a platoon needs (paper, section 3); the model file in C++. Without `types` in
/// its `string` the platoon is homogeneous; with the default link, too, it is the paper's.
///
/// A plain value: what uses a part of it checks that part (ClosedLoopBatch, AwgnChannel, FollowerVehicle,
/// LeaderVehicle throw std::invalid_argument), and the model file's parser checks all of it.
struct PlatoonModel {
  ClosedLoop loop;
  double headway;                    ///< h > 0, in sample periods
  double standstill_distance = 0.0;  ///< delta >= 0 [m]
  double sample_period = 0.1;        ///< T_s > 0 [s]; pacing and stamps only
  double noise_variance = 0.0;       ///< P_d >= 0 [m^2]
  LeaderProfile leader;
  InitialPosition initial_position;
  bool allow_unstable = false;            ///< rho(A) >= 1 was asked for
  std::optional<LoopDesign> design = {};  ///< none where the closed loop itself was given
  /// y_0(-1), y_0(0), ... [m]: vehicle 0 as it was recorded, in place of the loop behind `leader`. Empty: none.
  std::vector<double> recorded_leader = {};
  LinkModel link = {};                  ///< into every follower of the type `default`
  std::vector<VehicleType> types = {};  ///< other types of vehicle
  /// Type of followers 1, 2, ..., repeated: 0 is the vehicle above, n is types[n - 1]. Empty: all are 0.
  std::vector<std::size_t> string = {};
};

/// Follower i >= 1 of the platoon, and the vehicle above, which is the leader, for i = 0.
VehicleModel vehicle(const PlatoonModel& model, std::size_t follower);

/// One repetition of the string by types: 0 is the default vehicle, n is types[n - 1].
std::vector<std::size_t> type_order(const PlatoonModel& model);
VehicleModel vehicle_of_type(const PlatoonModel& model, std::size_t type);

/// Names of the types in the string, `default` among them, that follow the default vehicle's headway, or its loss
/// probability.
std::vector<std::string> types_with_default(const PlatoonModel& model, bool Inherited::*inherited);

/// The platoon with another headway, gain of the controller (leading coefficient of its numerator) or loss
/// probability of the default vehicle and of all types that inherit it, as the model file has it. Losses become
/// independent: a mean burst belongs to one probability. Throw std::invalid_argument where a closed loop was given,
/// which fits one headway, and where there is no loss.
PlatoonModel with_headway(PlatoonModel model, double headway);
PlatoonModel with_gain(PlatoonModel model, double gain);
PlatoonModel with_loss(PlatoonModel model, double probability);

/// One repetition of the string: each of its vehicles.
std::vector<VehicleModel> pattern(const PlatoonModel& model);

/// Whether all followers are of the type `default`.
bool is_homogeneous(const PlatoonModel& model);

/// Whether the platoon is the paper's: homogeneous, over channels that add white noise and nothing else.
bool is_papers(const PlatoonModel& model);

/// Whether all errors are normal, as they are without losses and quantisation.
bool has_normal_errors(const PlatoonModel& model);

/// Where follower i stands in formation: -(delta_1 + ... + delta_i) [m].
double place_in_formation(const PlatoonModel& model, std::size_t follower);

}  // namespace platoon
