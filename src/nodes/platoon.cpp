// The whole platoon in one process: the components of the nodes, joined by shared pointers.

#include <algorithm>
#include <cmath>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "stochastic_platoon/graph/channel.hpp"
#include "stochastic_platoon/graph/configuration_parameter.hpp"
#include "stochastic_platoon/graph/follower.hpp"
#include "stochastic_platoon/graph/leader.hpp"
#include "stochastic_platoon/graph/monitor.hpp"
#include "stochastic_platoon/graph/recorder.hpp"
#include "stochastic_platoon/graph/run_component.hpp"
#include "stochastic_platoon/graph/work_queue.hpp"

namespace {

// A queue with the one thread that serves it: each component is built on one queue, so none needs a lock.
class Worker {
public:
  explicit Worker(const ros::NodeHandle& node) : node_(node) { node_.setCallbackQueue(&queue_); }
  const ros::NodeHandle& node() const { return node_; }

  void start() {
    done_ = std::async(std::launch::async, [this] {
      try {
        queue_.run();
      } catch (...) {
        ros::shutdown();  // the other threads end too, and finish() passes the error on
        throw;
      }
    });
  }

  /// Waits for the thread; throws what ended it, if it was an error.
  void finish() { done_.get(); }

private:
  platoon::WorkQueue queue_;
  ros::NodeHandle node_;
  std::future<void> done_;
};

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "platoon", 0, [](const ros::NodeHandle& node) {
    const platoon::Configuration configuration = platoon::read_configuration(node);
    // Each thread has a part of the string with its channels, so that most messages stay in its core's
    // caches. The monitor looks at every position, which costs a quarter of making it.
    constexpr double kMonitorShare = 0.25;
    const std::size_t followers = configuration.run.followers;
    const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, followers);
    std::vector<std::unique_ptr<Worker>> workers;
    for (std::size_t t = 0; t < threads; ++t) workers.push_back(std::make_unique<Worker>(node));
    platoon::Monitor monitor(workers.back()->node(), configuration);
    std::unique_ptr<platoon::Recorder> recorder;
    if (!configuration.run.record.empty()) {
      recorder = std::make_unique<platoon::Recorder>(workers.back()->node(), configuration);
    }
    std::vector<std::unique_ptr<platoon::Channel>> channels;
    std::vector<std::unique_ptr<platoon::Follower>> vehicles;
    std::uint32_t first = 1;
    for (std::size_t t = 0; t < threads; ++t) {
      const double share = (1.0 + kMonitorShare) * static_cast<double>(t + 1) / static_cast<double>(threads);
      const double upto = std::min(1.0, share) * static_cast<double>(followers);
      const auto last = static_cast<std::uint32_t>(std::lround(upto));
      channels.push_back(std::make_unique<platoon::Channel>(workers[t]->node(), configuration, first, last));
      for (std::uint32_t i = first; i <= last; ++i) {
        vehicles.push_back(std::make_unique<platoon::Follower>(workers[t]->node(), configuration, i));
      }
      first = last + 1;
    }
    const platoon::Leader leader(workers.front()->node(), configuration);
    for (auto& worker : workers) worker->start();
    ros::spin();  // the global queue carries nothing but the signal to end
    for (auto& worker : workers) worker->finish();
    monitor.stop();
    if (recorder) recorder->stop();
  });
}
