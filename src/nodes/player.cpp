// Plays a bag into a monitor. Parameters: ~bags (file names, separated by spaces in one text), ~unverified (read bags
// without checksums), ~rate, ~start, ~pause. A bag that is damaged ends it with status 1.

#include "stochastic_platoon/graph/player.hpp"

#include "stochastic_platoon/hosting/run_component.hpp"

namespace {

void run(const ros::NodeHandle& platoon, const platoon::Configuration& configuration,
         platoon::Superseded& superseded) {
  const ros::NodeHandle own("~");
  platoon::PlayerOptions options;
  options.bags.files = platoon::bag_files(own.param<std::string>("bags", ""));
  options.bags.unverified = own.param("unverified", false);
  options.rate = own.param("rate", 0.0);
  options.start = own.param("start", 0.0);
  options.paused = own.param("pause", false);
  const platoon::Player player(platoon, own, configuration, options);
  superseded.spin();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, {"player"}, run);
}
