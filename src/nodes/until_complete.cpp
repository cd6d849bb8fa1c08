// Lives as long as the run: as a required node of a launch file its end ends the launch. It ends, with status
// 0, when all receivers report that they have finished.

#include <stochastic_platoon/Progress.h>

#include <algorithm>
#include <map>

#include "stochastic_platoon/hosting/run_component.hpp"
#include "stochastic_platoon/messages/topics.hpp"

namespace {

void run(ros::NodeHandle platoon, const platoon::Configuration& configuration,
         platoon::Superseded& superseded) {
  const std::uint64_t own_run = platoon::run_identity(configuration);
  std::map<std::string, bool> finished;
  for (const std::string& receiver : configuration.run.receivers()) finished[receiver] = false;
  const boost::function<void(const stochastic_platoon::Progress::ConstPtr&)> receive =
      [&finished, own_run](const stochastic_platoon::Progress::ConstPtr& message) {
        const auto receiver = finished.find(message->receiver);
        if (receiver == finished.end() || message->run != own_run) return;
        receiver->second = message->finished;
        if (std::all_of(finished.begin(), finished.end(), [](const auto& entry) { return entry.second; }))
          ros::shutdown();
      };
  const ros::Subscriber progress =
      platoon.subscribe<stochastic_platoon::Progress>(platoon::kProgressTopic, 100, receive);
  superseded.spin();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, {"until_complete"}, run);
}
