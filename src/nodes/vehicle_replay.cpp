// Replays a recording to one live follower. Parameters: ~bags, ~unverified, ~vehicle, ~patience (60 [s] without a new
// answer). Exits with status 0 if all messages of the follower equal the recording bit for bit, else, or if there is no
// verdict, with status 1 and the reason. With ~external the vehicle is an external one: its messages must be those of
// the recording, but its positions may differ.

#include "stochastic_platoon/ros/replay/vehicle_replay.hpp"

#include <ros/callback_queue.h>

#include <cstdio>
#include <stdexcept>

#include "stochastic_platoon/ros/hosting/run_component.hpp"

namespace {

void run_vehicle_replay(const ros::NodeHandle& platoon) {
  const std::optional<platoon::Configuration> configuration = platoon::wait_for_configuration(platoon);
  if (!configuration) return;
  const ros::NodeHandle private_node("~");
  const platoon::VehicleReplay replay(platoon, *configuration,
                                      {platoon::bag_files(private_node.param<std::string>("bags", "")),
                                       platoon::Accept::whole, private_node.param("unverified", false)},
                                      static_cast<std::size_t>(private_node.param("vehicle", 0)),
                                      private_node.param("external", false), private_node.param("patience", 60.0));
  while (ros::ok() && !replay.done()) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  if (!replay.done()) return;
  std::printf("%s\n", replay.verdict().c_str());
  std::fflush(stdout);
  if (!replay.equal()) throw std::runtime_error(replay.verdict());
  platoon::end_launch();
  while (ros::ok()) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
}

}  // namespace

int vehicle_replay_main(int argc, char** argv) {
  return platoon::run_node(
      argc, argv,
      {"vehicle_replay",
       "Replays bags to one live follower and compares its answers; replay.launch drive:=vehicle_I starts it.\n"
       "Parameters: _bags:='FILE ...', _vehicle:=I, _external, _patience [s], _unverified.\n"
       "Example: rosrun stochastic_platoon vehicle_replay __ns:=platoon _bags:=/tmp/run.bag _vehicle:=3"},
      run_vehicle_replay);
}
