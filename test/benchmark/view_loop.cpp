// A bare rosbag::View loop over the positions of a bag: the least cost of reading it. Prints JSON.

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <stochastic_platoon/Position.h>

#include <chrono>
#include <cstdio>
#include <regex>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const auto began = std::chrono::steady_clock::now();
  const rosbag::Bag bag(argv[1]);
  const std::regex position(".*/vehicle_[0-9]+/position");
  rosbag::View view(bag, [&position](const rosbag::ConnectionInfo* connection) {
    return std::regex_match(connection->topic, position);
  });
  double bytes = 0.0;
  for (const rosbag::MessageInstance& instance : view) {
    bytes += 8.0 * static_cast<double>(instance.instantiate<stochastic_platoon::Position>()->position.size());
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  std::printf("{\"seconds\": %.6g, \"bytes\": %.6g}\n", seconds, bytes);
}
