#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <string>
#include <vector>

#include "stochastic_platoon/bags/bag_stream.hpp"
#include "stochastic_platoon/configuration/configuration.hpp"

namespace platoon {

/// Puts one live follower behind the predecessor positions it was recorded with, and compares what it
/// publishes with what was recorded, bit by bit; of a vehicle that is somebody's own it measures how far apart they are.
/// The messages are those of the present run.
///
/// Subscribes: vehicle_<i>/position. Publishes: vehicle_<i>/predecessor_position. Both
/// stochastic_platoon/Position.
class VehicleReplay {
public:
  VehicleReplay(ros::NodeHandle platoon, const Configuration& configuration,
                const std::vector<std::string>& bags, std::size_t vehicle, bool own);

  bool done() const { return done_; }

  /// "vehicle_3: 2020 messages equal the recorded ones to the bit", or the first that does not; of an own vehicle
  /// how far its positions are from them at most.
  std::string verdict() const;
  bool equal() const { return done_ && difference_.empty(); }

private:
  using Message = stochastic_platoon::Position::ConstPtr;
  void receive(const Message& message);
  void play();
  void compare(const stochastic_platoon::Position& live, const stochastic_platoon::Position& recorded);

  std::string name_;
  std::uint64_t run_;
  std::int64_t window_;
  bool own_;
  double largest_ = 0.0;  ///< [m], between an own vehicle's position and the recorded one
  BagStream inputs_;
  BagStream outputs_;
  std::optional<RecordedPosition> expected_;
  std::int64_t sent_ = 0;
  std::int64_t received_ = 0;
  std::string difference_;  ///< the first one
  bool done_ = false;
  ros::Publisher predecessor_position_;
  ros::Subscriber position_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
