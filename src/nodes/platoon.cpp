// The whole platoon in one process: the components of the nodes, joined by shared pointers.

#include <algorithm>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "stochastic_platoon/graph/channel.hpp"
#include "stochastic_platoon/graph/follower.hpp"
#include "stochastic_platoon/graph/leader.hpp"
#include "stochastic_platoon/graph/message_pool.hpp"
#include "stochastic_platoon/graph/monitor.hpp"
#include "stochastic_platoon/graph/recorder.hpp"
#include "stochastic_platoon/graph/run_component.hpp"
#include "stochastic_platoon/graph/work_queue.hpp"

namespace {

// A queue with the one thread that serves it. Components are built on one queue, so that none needs a lock
// but the monitor, which is built on all.
class Worker {
public:
  explicit Worker(const ros::NodeHandle& node) : node_(node), node_at_once_(node) {
    node_.setCallbackQueue(&queue_);
    node_at_once_.setCallbackQueue(&at_once_);
  }
  const ros::NodeHandle& node() const { return node_; }
  /// For what should be called as soon as the callback that caused it is over.
  const ros::NodeHandle& at_once() const { return node_at_once_; }

  /// For the components of this thread.
  const platoon::MessagePool& messages() const { return messages_; }

  void start() {
    done_ = std::async(std::launch::async, [this] {
      try {
        queue_.run(at_once_);
      } catch (...) {
        ros::shutdown();  // the other threads end too, and finish() passes the error on
        throw;
      }
    });
  }

  /// Waits for the thread; throws what ended it, if it was an error.
  void finish() { done_.get(); }

private:
  platoon::WorkQueue queue_, at_once_;
  ros::NodeHandle node_, node_at_once_;
  platoon::MessagePool messages_;
  std::future<void> done_;
};

void run(const ros::NodeHandle& node, const platoon::Configuration& configuration) {
  // The string is cut into short segments: vehicles, the channels into them, and what the monitor does of
  // their positions. So most messages stay in one core's caches, and a batch on its way through a long
  // string still keeps all threads busy. They are dealt out there and back, because a batch reaches the end
  // of the string later and is over there earlier.
  constexpr std::size_t kLongestSegment = 5;
  const std::size_t followers = configuration.run.followers;
  const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, followers);
  const std::size_t round = 2 * threads;
  const std::size_t length = std::min(kLongestSegment, (followers + round - 1) / round);
  std::vector<std::unique_ptr<Worker>> workers;
  for (std::size_t t = 0; t < threads; ++t) workers.push_back(std::make_unique<Worker>(node));
  const auto worker_of = [&](std::size_t vehicle) -> const Worker& {
    const std::size_t segment = vehicle == 0 ? 0 : (vehicle - 1) / length % round;
    return *workers[std::min(segment, round - 1 - segment)];
  };
  platoon::Monitor monitor(workers.back()->node(), configuration,
                           [&](std::size_t vehicle) { return worker_of(vehicle).node(); });
  std::unique_ptr<platoon::Recorder> recorder;
  if (!configuration.run.record.empty()) {
    recorder = std::make_unique<platoon::Recorder>(workers.back()->node(), configuration);
  }
  std::vector<std::unique_ptr<platoon::Channel>> channels;
  std::vector<std::unique_ptr<platoon::Follower>> vehicles;
  for (std::uint32_t i = 1; i <= followers; ++i) {
    const Worker& worker = worker_of(i);
    channels.push_back(
        std::make_unique<platoon::Channel>(worker.node(), configuration, i, i, worker.messages()));
    vehicles.push_back(
        std::make_unique<platoon::Follower>(worker.at_once(), configuration, i, worker.messages()));
  }
  const platoon::Leader leader(workers.front()->node(), configuration);
  for (auto& worker : workers) worker->start();
  platoon::spin();  // the global queue carries nothing but the signal to end
  for (auto& worker : workers) worker->finish();
  monitor.stop();
  if (recorder) recorder->stop();
}

}  // namespace

int main(int argc, char** argv) {
  return platoon::run_component(argc, argv, "platoon", 0, run, 0);
}
