// Ends the launch when all receivers report that they have finished. As a required node it also ends the launch when it
// is killed.

#include <stochastic_platoon/Progress.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "stochastic_platoon/ros/hosting/run_component.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/sole_publisher.hpp"

namespace {

using stochastic_platoon::Progress;

// Whether each receiver has finished. Like the leader, it accepts a receiver's reports from one node only.
class Finished {
public:
  Finished(const ros::NodeHandle& platoon, const platoon::Configuration& configuration)
      : run_(platoon::run_identity(configuration)) {
    const std::string topic = platoon.resolveName(platoon::kProgressTopic);
    for (const std::string& name : configuration.run.receivers())
      receivers_.emplace(name, Receiver{platoon::SolePublisher(topic + " of " + name), false});
  }

  void receive(const ros::MessageEvent<const Progress>& event) {
    const Progress::ConstPtr message = event.getMessage();
    const auto found = receivers_.find(message->receiver);
    if (found == receivers_.end() || message->run != run_) return;
    Receiver& receiver = found->second;
    if (receiver.reporter.admits(event.getConnectionHeaderPtr(), run_)) receiver.finished = message->finished;
    const bool all =
        std::all_of(receivers_.begin(), receivers_.end(), [](const auto& entry) { return entry.second.finished; });
    if (all && !std::exchange(ended_, true)) platoon::end_launch();
  }

private:
  struct Receiver {
    platoon::SolePublisher reporter;
    bool finished;
  };
  std::uint64_t run_;
  std::map<std::string, Receiver> receivers_;
  bool ended_ = false;
};

void run(ros::NodeHandle platoon, const platoon::Configuration& configuration, platoon::Superseded& superseded) {
  Finished finished(platoon, configuration);
  const ros::Subscriber progress = platoon.subscribe(platoon::kProgressTopic, 100, &Finished::receive, &finished);
  superseded.spin();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(
      argc, argv, {"until_complete", "Ends its launch when the run is complete. platoon.launch starts it."}, run);
}
