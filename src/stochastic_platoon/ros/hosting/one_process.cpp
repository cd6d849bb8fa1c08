#include "stochastic_platoon/ros/hosting/one_process.hpp"

#include <ros/init.h>

#include <atomic>
#include <future>

#include "stochastic_platoon/ros/hosting/work_queue.hpp"
#include "stochastic_platoon/ros/messages/message_pool.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon {

/// A queue and the thread that serves it.
class OneProcess::Worker {
public:
  explicit Worker(const ros::NodeHandle& node) : node_(node), node_at_once_(node) {
    node_.setCallbackQueue(&queue_);
    node_at_once_.setCallbackQueue(&at_once_);
  }
  const ros::NodeHandle& node() const { return node_; }
  /// For callbacks that must run directly after the callback that caused them.
  const ros::NodeHandle& at_once() const { return node_at_once_; }

  /// For the components of this thread.
  const MessagePool& messages() const { return messages_; }

  void start() {
    done_ = std::async(std::launch::async, [this] {
      try {
        queue_.run(at_once_, [this] { return !ended_ && ros::ok(); });
      } catch (...) {
        ros::shutdown();  // the other threads end too, and finish() rethrows the error
        throw;
      }
    });
  }

  /// Waits for the thread; rethrows the error that ended it, if any.
  void finish() {
    ended_ = true;
    if (done_.valid()) done_.get();
  }

private:
  WorkQueue queue_, at_once_;
  ros::NodeHandle node_, node_at_once_;
  MessagePool messages_;
  std::atomic<bool> ended_{false};
  std::future<void> done_;
};

namespace {

template <typename Component>
VitalSigns::Sources all_sources(const std::vector<std::unique_ptr<Component>>& components) {
  VitalSigns::Sources all;
  for (const auto& component : components) {
    const VitalSigns::Sources own = component->sources();
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

}  // namespace

OneProcess::OneProcess(const ros::NodeHandle& platoon, const Configuration& configuration, std::size_t threads,
                       const RunMembership::Join& superseded)
    : segments_(configuration.run.followers, threads) {
  for (std::size_t t = 0; t < segments_.threads(); ++t) workers_.push_back(std::make_unique<Worker>(platoon));
  const ros::NodeHandle& last = workers_.back()->node();
  monitor_ = std::make_unique<Monitor>(
      last, configuration, [this](std::size_t vehicle) { return worker_of(vehicle).node(); }, superseded);
  if (!configuration.run.record.empty()) recorder_ = std::make_unique<Recorder>(last, configuration, superseded);
  const auto received = std::make_shared<Snapshots>(last, kPredecessorSnapshotTopic, configuration.run.followers);
  for (std::uint32_t i = 1; i <= configuration.run.followers; ++i) {
    const Worker& worker = worker_of(i);
    channels_.push_back(
        std::make_unique<Channel>(worker.node(), configuration, i, i, worker.messages(), received, superseded));
    if (configuration.run.is_external(i)) continue;
    followers_.push_back(std::make_unique<Follower>(worker.at_once(), configuration, i, false, worker.messages()));
  }
  leader_ = std::make_unique<Leader>(workers_.front()->node(), configuration, superseded);
  diagnostics_ = std::make_unique<Diagnostics>(last);
  diagnostics_->add("leader", leader_->status());
  diagnostics_->add("followers", VitalSigns(all_sources(followers_)));
  diagnostics_->add("channel", VitalSigns(all_sources(channels_)));
  diagnostics_->add("monitor", monitor_->status());
  if (recorder_) diagnostics_->add("recorder", VitalSigns(recorder_->sources()));
}

OneProcess::~OneProcess() = default;

void OneProcess::start() {
  for (const auto& worker : workers_) worker->start();
}

void OneProcess::stop() {
  for (const auto& worker : workers_) worker->finish();
  monitor_->stop();
  if (recorder_) recorder_->stop();
}

}  // namespace platoon
