// A roscpp node that does nothing: the reference for start-up times.

#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "empty_node", ros::init_options::NoRosout);
  const ros::NodeHandle node;
  ros::spin();
}
