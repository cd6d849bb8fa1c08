#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <stochastic_platoon/Position.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace platoon {

template <class Pointer>
class MessageSets;

/// What a vehicle receives, in the order of `inputs` in the model file (see config/README.md).
struct VehicleInput {
  std::string signal;  ///< "position" [m], "speed" [m/s], "acceleration" or "input" [m/s^2]
  std::size_t source;  ///< the vehicle that it comes from
  double gain;         ///< weight of a position, gain of any other signal
  std::string topic;   ///< relative to the platoon's namespace
};

/// The settings of one vehicle in a run.
struct VehicleSettings {
  double headway;                    ///< h, in sample periods; 0 with constant spacing
  double standstill_distance;        ///< delta_i, to its predecessor [m]
  double sample_period;              ///< T_s [s]
  double initial_position;           ///< at step -1 [m]: -(delta_1 + ... + delta_i), and behind it for a steady start
  double initial_speed;              ///< V [m/s], at which all vehicles have driven up to step -1; 0: at rest
  bool hears_input;                  ///< it has a radio: its predecessor's control input is part of every step
  std::vector<VehicleInput> inputs;  ///< at least one
};

/// The settings of vehicle `index` in the present run of the platoon in this namespace, from its parameter
/// `configuration`. A vehicle that outlives a run reads them in Start. Throws std::invalid_argument if index is 0, and
/// std::runtime_error if the parameter is absent or not a configuration.
VehicleSettings vehicle_settings(const ros::NodeHandle& platoon, std::size_t index);

/// The same from the text of that parameter.
VehicleSettings vehicle_settings_in(const std::string& configuration, std::size_t index);

/// An external vehicle with any dynamics that keeps the vehicle contract (msg/README.md). Other packages link this
/// class; it depends only on the messages of this package.
///
/// On step k of its inputs, as received, it publishes its own step k, and then moves on to k + 1. It notices another
/// run by the first of its inputs in the run before, at first by its predecessor's position.
///
/// Subscribes: `vehicle_<i>/predecessor_position`, with MoveByRadio also `vehicle_<i>/predecessor_input`, with
/// MoveByInputs the topics of VehicleSettings::inputs. Publishes: `vehicle_<i>/position`, and unless given a Move also
/// `vehicle_<i>/input`. All stochastic_platoon/Position.
class ExternalVehicle {
public:
  /// Step -1 of a batch: resets all state, and writes the initial positions y(-1) [m]; the vector has the batch's size,
  /// one position per realization.
  using Start = std::function<void(std::vector<double>& position)>;

  /// Computes y(k + 1) [m] from the predecessor's positions at step k, as received; both have the batch's size.
  using Move = std::function<void(const std::vector<double>& received, std::vector<double>& position)>;

  /// The same for a predecessor that sends its control input: from the predecessor's positions and control inputs
  /// [m/s^2] at step k, as received, computes y(k + 1) and the vehicle's input u(k), which counts as of step k + 1.
  /// `heard` is empty in a run in which the vehicle has no radio.
  using MoveByRadio = std::function<void(const std::vector<double>& received, const std::vector<double>& heard,
                                         std::vector<double>& position, std::vector<double>& input)>;

  /// The same for any inputs: received[n] is VehicleSettings::inputs[n] at step k, as received.
  using MoveByInputs = std::function<void(const std::vector<std::vector<double>>& received,
                                          std::vector<double>& position, std::vector<double>& input)>;

  /// Vehicle `index` of the platoon in this namespace (usually /platoon). Throws std::invalid_argument if index is 0.
  ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, Move move);

  /// The same with control inputs. It reads in the parameter `configuration` whether it has a radio in a run.
  ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, MoveByRadio move);

  /// The same with any inputs. It reads in the parameter `configuration` what it hears in a run.
  ExternalVehicle(ros::NodeHandle platoon, std::size_t index, Start start, MoveByInputs move);

private:
  using Message = stochastic_platoon::Position;

  /// What it hears of its predecessor, or all inputs.
  enum class Hears { position, radio, all };
  ExternalVehicle(const ros::NodeHandle& platoon, std::size_t index, Start start, MoveByInputs move, Hears hears);

  /// The messages of one topic, in turn.
  struct Stream {
    ros::Subscriber subscriber = {};
    Message::ConstPtr latest = {};
    std::optional<std::size_t> number = {};  ///< of the input in the present run; none: not heard there

    bool takes(const Message::ConstPtr& message);
  };
  void subscribe(const std::string& topic);
  std::vector<std::string> heard_topics() const;
  void begin(std::uint64_t run);
  void receive(const std::string& topic, const Message::ConstPtr& message);
  void answer(const std::vector<Message::ConstPtr>& received);
  void publish(const ros::Publisher& publisher, const Message& received, const std::vector<double>& values) const;

  ros::NodeHandle platoon_;
  std::size_t index_;
  Start start_;
  MoveByInputs move_;
  Hears hears_;
  std::uint64_t run_ = 0;                                 ///< the present one; 0: none yet
  std::map<std::string, Stream> streams_;                 ///< by topic
  std::shared_ptr<MessageSets<Message::ConstPtr>> sets_;  ///< of all inputs of a step
  std::vector<double> own_, own_input_;                   ///< y [m] and u [m/s^2] of the step that is published next
  ros::Publisher position_, input_;
};

}  // namespace platoon
