#include "stochastic_platoon/ros/observation/markers.hpp"

#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/observation/road_scene.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"

namespace platoon {

namespace {

constexpr std::size_t kMostLabels = 30;
// Smoothing of the view per snapshot: keeps the camera still while the last vehicle oscillates.
constexpr double kSmoothing = 0.05;

geometry_msgs::TransformStamped frame(const std::string& name, double x, const ros::Time& time) {
  geometry_msgs::TransformStamped made;
  made.header.frame_id = "platoon";
  made.header.stamp = time;
  made.child_frame_id = name;
  made.transform.translation.x = x;
  made.transform.rotation.w = 1.0;
  return made;
}

std::vector<double> lengths_of(const Configuration& configuration) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i <= configuration.run.followers; ++i)
    lengths.push_back(vehicle(configuration.model, i).length);
  return lengths;
}

// Per vehicle, those that it hears across others.
std::vector<std::vector<std::size_t>> far_sources(const Configuration& configuration) {
  std::vector<std::vector<std::size_t>> sources(1);
  for (std::size_t i = 1; i <= configuration.run.followers; ++i) {
    std::set<std::size_t> heard;
    for (const Input& input : vehicle(configuration.model, i).inputs) heard.insert(source_of(input, i));
    heard.erase(i - 1);
    sources.emplace_back(heard.begin(), heard.end());
  }
  return sources;
}

// RViz keeps the markers of a node that has ended: those of a run with more vehicles would stay on the road.
void delete_all(const ros::SingleSubscriberPublisher& viewer) {
  visualization_msgs::MarkerArray message;
  message.markers.resize(1);
  message.markers.front().action = visualization_msgs::Marker::DELETEALL;
  viewer.publish(message);
}

}  // namespace

Markers::Markers(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded)
    : membership_(platoon, "markers", run_identity(configuration), std::move(superseded)),
      run_(configuration.run),
      variance_(predict(configuration).variance),
      lengths_(lengths_of(configuration)),
      far_sources_(far_sources(configuration)),
      markers_(
          platoon.advertise<visualization_msgs::MarkerArray>("markers", 1, ros::SubscriberStatusCallback(delete_all))),
      frames_(platoon.advertise<tf2_msgs::TFMessage>("/tf", 10)) {
  snapshots_ = platoon.subscribe(kSnapshotTopic, 1, &Markers::receive, this);
}

void Markers::receive(const stochastic_platoon::Snapshot::ConstPtr& message) {
  if (!membership_.admits(message->run)) return;
  const std::vector<double>& position = message->position;
  if (position.size() != run_.followers + 1 || message->tracking_error.size() != run_.followers) return;
  if (message->step < 0 || (run_.steps > 0 && message->step >= run_.steps)) return;
  const ros::Time time = ros::Time::now();
  publish_frames(*message, time);
  if (markers_.getNumSubscribers() == 0) return;
  const std::size_t every = 1 + run_.followers / kMostLabels;
  std::vector<SceneVehicle> vehicles{{0.0, lengths_[0], std::nan(""), std::nan(""), false, "leader"}};
  for (std::size_t i = 1; i <= run_.followers; ++i) {
    const double x = position[i] - position[0], error = message->tracking_error[i - 1];
    const double gap = position[i - 1] - position[i] - lengths_[i - 1];
    const std::size_t cell =
        run_.averaging() == Averaging::over_time ? i - 1 : platoon::cell(i, message->step, run_.steps);
    SceneVehicle shown{x, lengths_[i], x + error, std::sqrt(variance_[cell]), is_closing(gap, error), ""};
    if (i % every == 0 || i == run_.followers) {
      shown.label = formatted("%zu\n%+.1f", i, error);
      shown.hears = far_sources_[i];
    }
    vehicles.push_back(shown);
  }
  markers_.publish(road_scene(vehicles, position[0], time));
}

// Frames instead of poses: other RViz displays can be attached to a vehicle.
void Markers::publish_frames(const stochastic_platoon::Snapshot& snapshot, const ros::Time& time) {
  const double leader = snapshot.position.front();
  const double tail = snapshot.position.back() - lengths_.back() - leader;
  tail_ = tail_ == 0.0 || std::abs(tail - tail_) > 100.0 ? tail : tail_ + kSmoothing * (tail - tail_);
  tf2_msgs::TFMessage frames;
  for (std::size_t i = 0; i < snapshot.position.size(); ++i)
    frames.transforms.push_back(frame(vehicle_name(i), snapshot.position[i] - leader, time));
  frames.transforms.push_back(frame("platoon_tail", tail_, time));
  frames_.publish(frames);
}

}  // namespace platoon
