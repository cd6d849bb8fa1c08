// The whole platoon in one process.

#include <thread>

#include "stochastic_platoon/ros/hosting/one_process.hpp"
#include "stochastic_platoon/ros/hosting/run_component.hpp"

namespace {

void run_platoon(const ros::NodeHandle& platoon, const platoon::Configuration& configuration,
                 platoon::Superseded& superseded) {
  platoon::keep_freed_memory(configuration.run, configuration.run.followers + 1);
  platoon::OneProcess process(platoon, configuration, std::thread::hardware_concurrency(), superseded.join());
  process.start();
  superseded.spin();
  process.stop();
}

}  // namespace

int platoon_main(int argc, char** argv) {
  return platoon::run_component(
      argc, argv,
      {"platoon",
       "The whole platoon in one process. platoon.launch hosting:=one_process starts it.\nExample: rosrun stochastic_platoon platoon __ns:=platoon",
       0, 0},
      run_platoon);
}
