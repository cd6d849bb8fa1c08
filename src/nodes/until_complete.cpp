// Lives as long as the run: as a required node of a launch file its end ends the launch. It ends, with status
// 0, when all receivers report that they have finished.

#include <stochastic_platoon/Progress.h>

#include <algorithm>
#include <map>

#include "stochastic_platoon/graph/run_component.hpp"
#include "stochastic_platoon/graph/wire.hpp"

namespace {

void run(ros::NodeHandle node, const platoon::Configuration& configuration) {
  std::map<std::string, bool> finished;
  for (const std::string& receiver : configuration.run.receivers()) finished[receiver] = false;
  const boost::function<void(const stochastic_platoon::Progress::ConstPtr&)> receive =
      [&finished](const stochastic_platoon::Progress::ConstPtr& message) {
        const auto receiver = finished.find(message->receiver);
        if (receiver == finished.end()) return;
        receiver->second = message->finished;
        if (std::all_of(finished.begin(), finished.end(), [](const auto& entry) { return entry.second; }))
          ros::shutdown();
      };
  const ros::Subscriber progress = node.subscribe<stochastic_platoon::Progress>("progress", 100, receive);
  platoon::spin();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "until_complete", 0, run);
}
