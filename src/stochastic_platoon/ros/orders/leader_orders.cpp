#include "stochastic_platoon/ros/orders/leader_orders.hpp"

#include <ros/console.h>

#include <boost/function.hpp>
#include <cmath>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/report/plausibility.hpp"

namespace platoon {

LeaderOrders::LeaderOrders(ros::NodeHandle platoon, std::function<Manoeuvre&()> of_leader)
    : manoeuvre_(std::move(of_leader)) {
  advertise(platoon, "leader/brake", [](Manoeuvre& manoeuvre) {
    manoeuvre.brake();
    return formatted("the leader brakes by %g m/s^2 until it stands", manoeuvre.bounds().braking);
  });
  advertise(platoon, "leader/accelerate", [](Manoeuvre& manoeuvre) {
    manoeuvre.accelerate();
    const ManoeuvreBounds of = manoeuvre.bounds();
    return formatted("the leader accelerates by %g m/s^2 until it is %g m/s faster, to %g m/s at most", of.speed_up,
                     of.speed_added, of.speed.upper);
  });
  advertise(platoon, "leader/sinusoid", [](Manoeuvre& manoeuvre) {
    manoeuvre.swing();
    const ManoeuvreBounds of = manoeuvre.bounds();
    return formatted("the leader's speed swings by %g m/s with a period of %g s", of.amplitude, of.seconds);
  });
  advertise(platoon, "leader/cruise", [](Manoeuvre& manoeuvre) {
    if (!manoeuvre.is_under_way()) return std::string("the leader drives by the model file already");
    manoeuvre.cruise();
    const ManoeuvreBounds of = manoeuvre.bounds();
    return formatted("the leader returns to the speed of the model file by %g to %g m/s^2", of.back.lower,
                     of.back.upper);
  });
  speed_ = platoon.subscribe("leader/speed", 10, &LeaderOrders::receive_speed, this);
}

void LeaderOrders::advertise(ros::NodeHandle platoon, const std::string& service, const Order& order) {
  using Request = std_srvs::Trigger::Request;
  using Response = std_srvs::Trigger::Response;
  const boost::function<bool(Request&, Response&)> serve = [this, service, order](Request&, Response& response) {
    try {
      response.message = order(manoeuvre_());
      response.success = 1;
      ROS_INFO_STREAM(response.message);
    } catch (const std::exception& error) {
      response.message = service + ": " + error.what();
      ROS_WARN_STREAM(response.message);
    }
    return true;
  };
  services_.push_back(platoon.advertiseService(service, serve));
}

void LeaderOrders::receive_speed(const std_msgs::Float64::ConstPtr& message) {
  const double speed = message->data;
  try {
    manoeuvre_().drive_at(speed);
    ROS_INFO_STREAM("the leader drives at " << speed << " m/s");
    if (std::abs(speed) > kFastestCar) {
      ROS_WARN_STREAM_THROTTLE(
          1.0, "leader/speed: " << speed << " m/s (" << 3.6 * speed << " km/h): cars reach " << kFastestCar << " m/s");
    }
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(1.0, "leader/speed: " << error.what());
  }
}

}  // namespace platoon
