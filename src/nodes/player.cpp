// Plays a bag into a monitor. Parameters: ~bags (file names, separated by spaces in one text), ~unverified (read bags
// without checksums), ~rate, ~start, ~pause. Exits with status 1 if a bag is damaged.

#include "stochastic_platoon/ros/replay/player.hpp"

#include "stochastic_platoon/ros/hosting/run_component.hpp"

namespace {

void run_player(const ros::NodeHandle& platoon, const platoon::Configuration& configuration,
                platoon::Superseded& superseded) {
  const ros::NodeHandle private_node("~");
  platoon::PlayerOptions options;
  options.bags.files = platoon::bag_files(private_node.param<std::string>("bags", ""));
  options.bags.unverified = private_node.param("unverified", false);
  options.rate = private_node.param("rate", 0.0);
  options.start = private_node.param("start", 0.0);
  options.paused = private_node.param("pause", false);
  const platoon::Player player(platoon, private_node, configuration, options);
  superseded.spin();
}

}  // namespace

int player_main(int argc, char** argv) {
  return platoon::run_component(
      argc, argv,
      {"player",
       "Plays bags into a monitor; replay.launch starts it. Parameters: _bags:='FILE ...', _unverified, _rate, _start, _pause.\nExample: rosrun stochastic_platoon player __ns:=platoon _bags:=/tmp/run.bag"},
      run_player);
}
