// A bare roscpp flood: one process publishes Position messages of one size as fast as another receives them.
// The reference for the graph's deliveries. Usage: flood source SIZE COUNT | flood sink COUNT, or, with one
// message in flight at a time, flood ping SIZE COUNT | flood pong COUNT. Sink and ping print JSON.

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <stochastic_platoon/Position.h>

#include <boost/make_shared.hpp>
#include <cstdio>
#include <cstdlib>
#include <string>

using stochastic_platoon::Position;

namespace {

constexpr int kWindow = 256;  // messages in flight: bounded like those of the platoon

int source(ros::NodeHandle node, std::size_t size, int count) {
  int acknowledged = 0;
  const ros::Publisher out = node.advertise<Position>("flood", 0);
  const boost::function<void(const Position::ConstPtr&)> receive = [&](const Position::ConstPtr& message) {
    acknowledged = static_cast<int>(message->step);
  };
  const ros::Subscriber back =
      node.subscribe<Position>("flood_back", 0, receive, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  while (ros::ok() && (out.getNumSubscribers() == 0 || back.getNumPublishers() == 0)) ros::WallDuration(0.01).sleep();
  for (int sent = 0; ros::ok() && sent < count;) {
    while (sent < count && sent - acknowledged < kWindow) {
      const auto message = boost::make_shared<Position>();
      message->step = ++sent;
      message->position.resize(size);
      out.publish(message);
    }
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  }
  while (ros::ok() && acknowledged < count) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  return 0;
}

int sink(ros::NodeHandle node, int count) {
  ros::SteadyTime began;
  const ros::Publisher back = node.advertise<Position>("flood_back", 0);
  int received = 0;
  std::size_t size = 0;
  const boost::function<void(const Position::ConstPtr&)> receive = [&](const Position::ConstPtr& message) {
    if (received++ == 0) began = ros::SteadyTime::now();
    size = message->position.size();
    if (received % (kWindow / 4) == 0 || received == count) {
      Position acknowledgement;
      acknowledgement.step = message->step;
      back.publish(acknowledgement);
    }
  };
  const ros::Subscriber in =
      node.subscribe<Position>("flood", 0, receive, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  while (ros::ok() && received < count) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  const double seconds = (ros::SteadyTime::now() - began).toSec();
  std::printf("{\"messages_per_second\": %.6g, \"bytes_per_second\": %.6g}\n", count / seconds,
              count / seconds * 8.0 * static_cast<double>(size));
  std::fflush(stdout);
  ros::WallDuration(0.2).sleep();  // the last acknowledgement is in flight
  return 0;
}

int ping(ros::NodeHandle node, std::size_t size, int count) {
  int returned = 0;
  ros::SteadyTime began;
  const auto message = boost::make_shared<Position>();
  message->position.resize(size);
  const ros::Publisher out = node.advertise<Position>("flood", 0);
  const boost::function<void(const Position::ConstPtr&)> receive = [&](const Position::ConstPtr&) {
    if (++returned < count) out.publish(message);
  };
  const ros::Subscriber back =
      node.subscribe<Position>("flood_back", 0, receive, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  while (ros::ok() && (out.getNumSubscribers() == 0 || back.getNumPublishers() == 0)) ros::WallDuration(0.01).sleep();
  ros::WallDuration(0.2).sleep();  // the other side connects, too
  began = ros::SteadyTime::now();
  out.publish(message);
  while (ros::ok() && returned < count) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  std::printf("{\"round_trips_per_second\": %.6g}\n", count / (ros::SteadyTime::now() - began).toSec());
  return 0;
}

int pong(ros::NodeHandle node, int count) {
  int received = 0;
  const ros::Publisher back = node.advertise<Position>("flood_back", 0);
  const boost::function<void(const Position::ConstPtr&)> receive = [&](const Position::ConstPtr& message) {
    ++received;
    back.publish(message);
  };
  const ros::Subscriber in =
      node.subscribe<Position>("flood", 0, receive, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  while (ros::ok() && received < count) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  ros::WallDuration(0.2).sleep();  // the last message is in flight
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string role = argc > 1 ? argv[1] : "";
  ros::init(argc, argv, "flood_" + role, ros::init_options::NoRosout);
  if (role == "source" && argc == 4) return source(ros::NodeHandle(), std::stoul(argv[2]), std::atoi(argv[3]));
  if (role == "sink" && argc == 3) return sink(ros::NodeHandle(), std::atoi(argv[2]));
  if (role == "ping" && argc == 4) return ping(ros::NodeHandle(), std::stoul(argv[2]), std::atoi(argv[3]));
  if (role == "pong" && argc == 3) return pong(ros::NodeHandle(), std::atoi(argv[2]));
  std::fprintf(stderr, "usage: flood source|ping SIZE COUNT, flood sink|pong COUNT\n");
  return 2;
}
