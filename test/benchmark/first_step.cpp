// Waits for the master and for the first step that the platoon's monitor acknowledges, then ends. Measures
// start-up times.

#include <ros/ros.h>
#include <stochastic_platoon/Progress.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "first_step", ros::init_options::NoRosout);
  ros::NodeHandle node;
  const boost::function<void(const stochastic_platoon::Progress::ConstPtr&)> receive =
      [](const stochastic_platoon::Progress::ConstPtr& message) {
        if (message->first_realization > 0 || message->step >= 0) ros::shutdown();
      };
  const ros::Subscriber progress = node.subscribe<stochastic_platoon::Progress>("platoon/progress", 0, receive);
  ros::spin();
}
