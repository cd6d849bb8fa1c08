// Lives as long as the run: as a required node of a launch file its end ends the launch. It ends, with status
// 0, when all receivers report that they have every realization.

#include <stochastic_platoon/Progress.h>

#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/run_component.hpp"
#include "stochastic_platoon/graph/wire.hpp"

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "until_complete", 0, [](ros::NodeHandle node) {
    const platoon::BatchSchedule schedule = platoon::read_configuration(node).run.schedule();
    const boost::function<void(const stochastic_platoon::Progress::ConstPtr&)> receive =
        [&schedule](const stochastic_platoon::Progress::ConstPtr& message) {
          if (schedule.is_complete(message->first_realization)) ros::shutdown();
        };
    const ros::Subscriber progress = node.subscribe<stochastic_platoon::Progress>("progress", 100, receive);
    ros::spin();
  });
}
