#include "stochastic_platoon/ros/transport/sole_publisher.hpp"

#include <ros/console.h>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"

namespace platoon {

bool SolePublisher::looks_and_admits(const Header& connection, std::uint64_t run) {
  const auto caller = connection ? connection->find("callerid") : ros::M_string::iterator();
  const std::string name =
      connection && caller != connection->end() ? printable(shortened(caller->second)) : "(unnamed)";
  if (run != run_ || name == name_) {
    run_ = run;
    name_ = name;
    connection_ = connection;
    return true;
  }
  const double present = now();
  if (last_logged_ && present - *last_logged_ < 1.0) return false;
  last_logged_ = present;
  ROS_WARN_STREAM(topic_ << " has two publishers: " << name_ << ", which counts in this run, and " << name
                         << ", whose messages are dropped" << remark_);
  return false;
}

}  // namespace platoon
