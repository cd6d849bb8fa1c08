#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <stochastic_platoon/Position.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace platoon {

template <class Pointer>
class MessagePairs;

/// The settings of one vehicle in a run.
struct VehicleSettings {
  double headway;              ///< h, in sample periods
  double standstill_distance;  ///< delta_i, to its predecessor [m]
  double sample_period;        ///< T_s [s]
  double initial_position;     ///< at step -1 [m]: -(delta_1 + ... + delta_i), and behind it for a steady start
  double initial_speed;        ///< V [m/s], at which all vehicles have driven up to step -1; 0: at rest
  bool hears_input;            ///< it has a radio: its predecessor's control input is part of every step
};

/// The settings of vehicle `index` in the present run of the platoon in this namespace, from its parameter
/// `configuration`. A vehicle that outlives a run reads them in Start. Throws std::invalid_argument if index is 0, and
/// std::runtime_error if the parameter is absent or not a configuration.
VehicleSettings vehicle_settings(const ros::NodeHandle& platoon, std::size_t index);

/// An external vehicle with any dynamics that keeps the vehicle contract (msg/README.md). Other packages link this
/// class; it depends only on the messages of this package.
///
/// On its predecessor's step k, as received, it publishes its own step k, and then moves on to k + 1. With a radio it
/// waits for the predecessor's input of the same step, too.
///
/// Subscribes: `vehicle_<i>/predecessor_position`. Publishes: `vehicle_<i>/position`. With MoveByRadio also
/// `vehicle_<i>/predecessor_input` and `vehicle_<i>/input`. All stochastic_platoon/Position.
class ExternalVehicle {
public:
  /// Step -1 of a batch: resets all state, and writes the initial positions y(-1) [m]; the vector has the batch's size,
  /// one position per realization.
  using Start = std::function<void(std::vector<double>& position)>;

  /// Computes y(k + 1) [m] from the predecessor's positions at step k, as received; both have the batch's size.
  using Move = std::function<void(const std::vector<double>& received, std::vector<double>& position)>;

  /// The same in a string with radios: from the predecessor's positions and control inputs [m/s^2] at step k, as
  /// received, computes y(k + 1) and the vehicle's input u(k), which counts as of step k + 1. `heard` is empty in a run
  /// in which the vehicle has no radio.
  using MoveByRadio = std::function<void(const std::vector<double>& received, const std::vector<double>& heard,
                                         std::vector<double>& position, std::vector<double>& input)>;

  /// Vehicle `index` of the platoon in this namespace (usually /platoon). Throws std::invalid_argument if index is 0.
  ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, Move move);

  /// The same with control inputs. It reads in the parameter `configuration` whether it has a radio in a run.
  ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, MoveByRadio move);

private:
  using Message = stochastic_platoon::Position;

  ExternalVehicle(const ros::NodeHandle& platoon, std::size_t index, Start start, MoveByRadio move, bool radio);

  /// The messages of one topic, in turn.
  struct Stream {
    Message::ConstPtr latest;

    bool takes(const Message::ConstPtr& message);
  };
  void receive_position(const Message::ConstPtr& message);
  void receive_input(const Message::ConstPtr& message);
  void match();
  void answer(const Message& received, const std::vector<double>& heard);
  void publish(const ros::Publisher& publisher, const Message& received, const std::vector<double>& values) const;

  ros::NodeHandle platoon_;
  std::size_t index_;
  std::shared_ptr<MessagePairs<Message::ConstPtr>> pairs_;  ///< of positions and inputs, with a radio
  Start start_;
  MoveByRadio move_;
  bool hears_ = false;  ///< in the present run
  Stream positions_, inputs_;
  std::vector<double> own_, own_input_;  ///< y [m] and u [m/s^2] of the step that is published next
  ros::Publisher position_, input_;
  ros::Subscriber predecessor_position_, predecessor_input_;
};

}  // namespace platoon
