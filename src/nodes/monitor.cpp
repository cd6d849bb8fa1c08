#include "stochastic_platoon/ros/nodes/monitor.hpp"

#include "stochastic_platoon/ros/hosting/run_component.hpp"

namespace {

void run_monitor(const ros::NodeHandle& platoon, const platoon::Configuration& configuration,
                 platoon::Superseded& superseded) {
  const auto all_on_one = [&platoon](std::size_t) { return platoon; };
  platoon::Monitor monitor(platoon, configuration, all_on_one, superseded.join());
  platoon::Diagnostics diagnostics(platoon);
  diagnostics.add("monitor", monitor.status());
  superseded.spin();
  monitor.stop();
}

}  // namespace

int monitor_main(int argc, char** argv) {
  return platoon::run_component(
      argc, argv,
      {"monitor",
       "Computes and writes the statistics of a run, and names the node that blocks it. platoon.launch starts it.\nExample: rosrun stochastic_platoon monitor __ns:=platoon"},
      run_monitor);
}
