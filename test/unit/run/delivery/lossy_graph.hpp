#pragma once

#include <deque>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "stochastic_platoon/math/channel/awgn_channel.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/statistics/ensemble_statistics.hpp"
#include "stochastic_platoon/run/delivery/credit.hpp"
#include "stochastic_platoon/run/delivery/pipeline.hpp"
#include "stochastic_platoon/run/delivery/report_pace.hpp"
#include "stochastic_platoon/run/delivery/signal_assembly.hpp"

namespace platoon {

/// Properties and faults of a LossyGraph; probabilities per event.
struct Troubles {
  double drop = 0.0;           ///< a message is lost on its link
  double kill_leader = 0.0;    ///< a component is killed and restarts with its parameters only
  double kill_follower = 0.0;  ///< a random follower
  double kill_monitor = 0.0;   ///< restarts from its latest checkpoint
  double kill_recorder = 0.0;  ///< restarts after the batches that it has written
  bool recorder = false;       ///< whether there is one
  std::size_t pipeline_depth = 100;
};

/// The graph of nodes with queues instead of sockets and a simulated clock: leader, channel, followers, monitor and
/// recorder are built like the ROS components, events occur in random order, links come up late after a restart.
class LossyGraph {
public:
  LossyGraph(const PlatoonModel& model, const BatchSchedule& schedule, std::size_t followers, std::uint64_t noise_seed,
             const Troubles& troubles, unsigned chance);

  /// Runs until all receivers have acknowledged everything. Throws std::runtime_error after 3 million events.
  const EnsembleTotals& run();

  std::uint64_t positions_received() const { return positions_received_; }

  /// First realizations of the batches the recorder wrote, in that order.
  const std::vector<std::uint64_t>& recorded() const { return recorded_; }

  std::uint32_t attempts() const { return credit_->attempt(); }
  int kills() const { return kills_; }

private:
  static constexpr std::int64_t kWindow = 40;  ///< steps

  struct Message {
    MessageId id;
    Positions positions;
  };
  struct Link {
    std::deque<Message> queue;
    double up_from = 0.0;  ///< [s] earlier messages are lost
  };
  struct Report {
    std::string receiver;
    Acknowledgement acknowledgement;
    std::uint64_t messages;
  };
  struct Follower {
    MessageOrder order;
    FollowerVehicle vehicle;
    bool is_ahead;
    std::vector<double> upcoming = {};  ///< its next step, if it does not publish ahead
  };
  struct Checkpoint {
    EnsembleTotals totals;
    std::uint32_t attempts;
    std::uint64_t positions_received;
  };

  bool happens(double probability) { return std::uniform_real_distribution<double>()(chance_) < probability; }
  std::size_t any(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(chance_); }

  Follower new_follower(std::uint32_t index) const;
  void start_leader();
  void start_monitor();
  void commit(const CompleteBatch& batch);
  void start_recorder();
  void maybe_kill();
  void restart_link(Link& link);
  void restart_vehicle_links(std::size_t vehicle);
  void publish(std::size_t vehicle, const MessageId& id, const std::vector<double>& positions);

  // A receiver reports once all its links are up.
  bool all_up(const std::vector<Link>& links) const;
  void heartbeat();
  void report(const char* receiver, const Arrivals& arrivals, ReportPace& pace);
  void report_if_due(const char* receiver, const Arrivals& arrivals, ReportPace& pace);

  // Executes one random event of those that are possible.
  bool any_event();
  bool event(std::size_t kind);

  template <typename Receive>
  bool deliver(Link& link, const Receive& receive) {
    if (link.queue.empty()) return false;
    const Message message = link.queue.front();
    link.queue.pop_front();
    receive(message);
    return true;
  }

  bool deliver_progress();
  bool lead();
  void follow(std::size_t index, const Message& message);

  MessageDescriptor descriptor(const Message& message) const { return {message.id, message.positions->size(), true}; }

  void observe(std::size_t vehicle, const Message& message);
  void add_errors(const DueSignals& due);
  void record(std::size_t vehicle, const Message& message);

  PlatoonModel model_;
  BatchSchedule schedule_;
  std::uint64_t noise_seed_;
  Troubles troubles_;
  std::mt19937 chance_;
  ReportPace monitor_pace_{schedule_, kWindow};
  ReportPace recorder_pace_{schedule_, kWindow};
  LeaderVehicle leader_;
  std::unique_ptr<Credit> credit_;
  std::vector<Follower> followers_;
  std::vector<AwgnChannel> channels_;
  std::unique_ptr<EnsembleStatistics> statistics_;
  std::unique_ptr<SignalAssembly> assembly_;
  std::uint32_t attempts_seen_ = 0;
  std::uint64_t positions_received_ = 0;
  Checkpoint checkpoint_;
  std::unique_ptr<Arrivals> recorder_;
  std::vector<std::uint64_t> recorded_;
  std::vector<Link> to_channel_;   ///< from vehicle i, for follower i + 1
  std::vector<Link> to_monitor_;   ///< from vehicle i
  std::vector<Link> to_recorder_;  ///< from vehicle i
  std::deque<Report> progress_;
  double now_ = 0.0;             ///< [s]
  double next_heartbeat_ = 0.0;  ///< [s]
  int kills_ = 0;
};

}  // namespace platoon
