#include "stochastic_platoon/graph/markers.hpp"

#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <boost/function.hpp>
#include <cmath>

#include "stochastic_platoon/io/text.hpp"
#include "stochastic_platoon/messages/position.hpp"
#include "stochastic_platoon/messages/topics.hpp"

namespace platoon {

using stochastic_platoon::Position;
using visualization_msgs::Marker;

namespace {

constexpr double kPeriod = 0.05;  // [s]
constexpr double kLength = 2.5;   // [m] of the box; the model's vehicles have none

// From dark blue over green and yellow to dark red.
std_msgs::ColorRGBA colour(double share) {
  const auto ramp = [](double x) { return static_cast<float>(std::clamp(x, 0.0, 1.0)); };
  std_msgs::ColorRGBA c;
  c.r = share < 0.85 ? ramp(3.0 * share - 1.0) : ramp(1.0 - 3.0 * (share - 0.85));
  c.g = ramp(1.6 - 3.2 * std::abs(share - 0.5));
  c.b = share > 0.15 ? ramp(1.5 - 3.0 * share) : ramp(0.55 + 3.0 * share);
  c.a = 1.0F;
  return c;
}

Marker marker(int id, int type, double x, double z) {
  Marker made;
  made.header.frame_id = "platoon";
  made.header.stamp = ros::Time::now();
  made.id = id;
  made.type = type;
  made.pose.position.x = x;
  made.pose.position.z = z;
  made.pose.orientation.w = 1.0;
  return made;
}

}  // namespace

Markers::Markers(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded)
    : membership_(platoon, "markers", run_identity(configuration), std::move(superseded)),
      vehicles_(configuration.run.followers + 1),
      markers_(platoon.advertise<visualization_msgs::MarkerArray>("markers", 1)) {
  for (std::size_t i = 1; i <= configuration.run.followers; ++i)
    error_.push_back(tracking_error(configuration.model, i));
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    const boost::function<void(const Position::ConstPtr&)> callback =
        [this, i](const Position::ConstPtr& message) { receive(i, message); };
    positions_.push_back(platoon.subscribe<Position>(position_topic(i), 1, callback));
  }
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kPeriod), [this](const auto&) { publish(); });
}

void Markers::receive(std::size_t vehicle, const Position::ConstPtr& message) {
  if (message->position.empty() || !membership_.admits(message->run)) return;
  Vehicle& shown = vehicles_[vehicle];
  const double position = message->position.front();
  shown.before = shown.seen && message->step > kInitialStep ? shown.position : position;
  shown.position = position;
  shown.seen = true;
}

void Markers::publish() const {
  if (markers_.getNumSubscribers() == 0 || !vehicles_.front().seen) return;
  visualization_msgs::MarkerArray array;
  const double leader = vehicles_.front().position;
  const double last = std::max<double>(1.0, static_cast<double>(vehicles_.size()) - 2.0);
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    const Vehicle& vehicle = vehicles_[i];
    if (!vehicle.seen) continue;
    const int id = 2 * static_cast<int>(i);
    Marker box = marker(id, Marker::CUBE, vehicle.position - leader, 0.75);
    box.scale.x = kLength;
    box.scale.y = 1.8;
    box.scale.z = 1.5;
    box.color = colour(i == 0 ? 0.0 : (static_cast<double>(i) - 1.0) / last);
    if (i == 0) box.color.r = box.color.g = box.color.b = 0.4F;
    array.markers.push_back(box);
    // Two rows of labels: neighbours stand close.
    Marker label =
        marker(id + 1, Marker::TEXT_VIEW_FACING, vehicle.position - leader, i % 2 == 0 ? 2.6 : 4.4);
    label.scale.z = 1.2;
    label.color = box.color;
    const double error =
        i == 0 ? 0.0 : error_[i - 1](vehicles_[i - 1].position, vehicle.position, vehicle.before);
    label.text = i == 0 ? "leader" : formatted("%zu: %+.2f m", i, error);
    array.markers.push_back(label);
  }
  markers_.publish(array);
}

}  // namespace platoon
