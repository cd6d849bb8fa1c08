// The whole platoon in one process: the components of the nodes, joined by shared pointers.

#include <ros/callback_queue.h>

#include <future>
#include <memory>
#include <vector>

#include "stochastic_platoon/graph/channel.hpp"
#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/follower.hpp"
#include "stochastic_platoon/graph/leader.hpp"
#include "stochastic_platoon/graph/monitor.hpp"
#include "stochastic_platoon/graph/recorder.hpp"
#include "stochastic_platoon/graph/run_component.hpp"

namespace {

// A queue with the one thread that serves it: each component is built on one queue, so none needs a lock.
class Worker {
public:
  explicit Worker(const ros::NodeHandle& node) : node_(node) { node_.setCallbackQueue(&queue_); }
  const ros::NodeHandle& node() const { return node_; }

  void start() {
    done_ = std::async(std::launch::async, [this] {
      try {
        while (ros::ok()) queue_.callAvailable(ros::WallDuration(0.1));
      } catch (...) {
        ros::shutdown();  // the other threads end too, and finish() passes the error on
        throw;
      }
    });
  }

  /// Waits for the thread; throws what ended it, if it was an error.
  void finish() { done_.get(); }

private:
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  std::future<void> done_;
};

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "platoon", 0, [](const ros::NodeHandle& node) {
    const platoon::Configuration configuration = platoon::read_configuration(node);
    // Two threads of about equal work: drawing the noise costs as much as driving and watching the vehicles.
    Worker channels(node), vehicles(node);
    const platoon::Channel channel(channels.node(), configuration);
    platoon::Monitor monitor(vehicles.node(), configuration);
    std::vector<std::unique_ptr<platoon::Follower>> followers;
    for (std::uint32_t i = 1; i <= configuration.run.followers; ++i) {
      followers.push_back(std::make_unique<platoon::Follower>(vehicles.node(), configuration, i));
    }
    std::unique_ptr<platoon::Recorder> recorder;
    if (!configuration.run.record.empty()) {
      recorder = std::make_unique<platoon::Recorder>(channels.node(), configuration);
    }
    const platoon::Leader leader(vehicles.node(), configuration);
    vehicles.start();
    channels.start();
    ros::spin();  // the global queue carries nothing but the signal to end
    vehicles.finish();
    channels.finish();
    monitor.stop();
    if (recorder) recorder->stop();
  });
}
