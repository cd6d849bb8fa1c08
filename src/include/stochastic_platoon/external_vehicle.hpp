#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <stochastic_platoon/Position.h>

#include <cstddef>
#include <functional>
#include <vector>

namespace platoon {

/// The settings of one vehicle in a run.
struct VehicleSettings {
  double headway;              ///< h, in sample periods
  double standstill_distance;  ///< delta_i, to its predecessor [m]
  double sample_period;        ///< T_s [s]
  double initial_position;     ///< -(delta_1 + ... + delta_i) [m]
};

/// The settings of vehicle `index` in the present run of the platoon in this namespace, from its parameter
/// `configuration`. A vehicle that outlives a run reads them in Start. Throws std::invalid_argument if index is 0, and
/// std::runtime_error if the parameter is absent or not a configuration.
VehicleSettings vehicle_settings(const ros::NodeHandle& platoon, std::size_t index);

/// An external vehicle with any dynamics that keeps the vehicle contract (msg/README.md). Other packages link this
/// class; it depends only on the messages of this package.
///
/// On its predecessor's step k, as received, it publishes its own step k, and then moves on to k + 1.
///
/// Subscribes: vehicle_<i>/predecessor_position. Publishes: vehicle_<i>/position. Both
/// stochastic_platoon/Position.
class ExternalVehicle {
public:
  /// Step -1 of a batch: forgets everything, and writes the initial positions y(-1) [m]; the vector has the batch's
  /// size, one position per realization.
  using Start = std::function<void(std::vector<double>& position)>;

  /// Computes the own y(k + 1) [m] from the predecessor's positions at step k, as received; both have the batch's size.
  using Move = std::function<void(const std::vector<double>& received, std::vector<double>& position)>;

  /// Vehicle `index` of the platoon in this namespace (usually /platoon). Throws std::invalid_argument if index is 0.
  ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, Move move);

private:
  bool is_in_turn(const stochastic_platoon::Position& message) const;
  void receive(const stochastic_platoon::Position::ConstPtr& message);

  Start start_;
  Move move_;
  stochastic_platoon::Position::ConstPtr latest_;  ///< latest message that was answered
  std::vector<double> own_;                        ///< own y at the step after `latest_` [m]
  ros::Publisher position_;
  ros::Subscriber predecessor_position_;
};

}  // namespace platoon
