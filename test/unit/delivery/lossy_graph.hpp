#pragma once

#include <deque>
#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/delivery/assembly.hpp"
#include "stochastic_platoon/delivery/credit.hpp"
#include "stochastic_platoon/model/vehicle.hpp"
#include "stochastic_platoon/statistics/ensemble_statistics.hpp"

namespace platoon {

/// What goes wrong in a LossyGraph: probabilities per event.
struct Troubles {
  double drop = 0.0;           ///< a message is lost on its link
  double kill_leader = 0.0;    ///< a component is killed and started again, with nothing but its parameters
  double kill_follower = 0.0;  ///< one of them, by chance
  double kill_monitor = 0.0;   ///< it starts from its latest checkpoint
};

/// The graph of nodes with its queues instead of sockets and an invented clock: leader, channel, followers
/// and monitor as the ROS components are built, events in random order, links that come up late after a
/// restart.
class LossyGraph {
public:
  LossyGraph(const PlatoonModel& model, const BatchSchedule& schedule, std::size_t followers,
             std::uint64_t noise_seed, const Troubles& troubles, unsigned chance)
      : model_(model),
        schedule_(schedule),
        noise_seed_(noise_seed),
        troubles_(troubles),
        chance_(chance),
        leader_(model),
        checkpoint_{MomentTable(followers * static_cast<std::size_t>(schedule.steps)), 0},
        to_monitor_(followers + 1),
        to_channel_(followers) {
    for (std::uint32_t i = 1; i <= followers; ++i) {
      followers_.push_back(new_follower(i));
      channels_.emplace_back(model.noise_variance, noise_seed, i);
    }
    start_leader();
    start_monitor();
  }

  /// Runs until the leader knows that everything is there. Throws std::runtime_error when that takes for
  /// ever.
  const MomentTable& run() {
    for (std::int64_t event = 0; !credit_->complete(); ++event) {
      if (event > 3000000) throw std::runtime_error("the run does not end");
      now_ += 0.001;
      maybe_kill();
      if (now_ >= next_heartbeat_) heartbeat();
      if (!one_event()) now_ += 0.02;
    }
    return statistics_->committed();
  }

  std::uint64_t positions_received() const { return positions_received_; }
  std::uint32_t attempts() const { return credit_->attempt(); }
  int kills() const { return kills_; }

private:
  struct Message {
    Turn turn;
    Positions positions;
  };
  struct Link {
    std::deque<Message> queue;
    double up_from = 0.0;  ///< [s] what is sent before is lost
  };
  struct Follower {
    Sequence sequence;
    FollowerVehicle vehicle;
  };
  struct Checkpoint {
    MomentTable table;
    std::uint32_t attempts;
  };

  bool happens(double probability) { return std::uniform_real_distribution<double>()(chance_) < probability; }
  std::size_t any(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(chance_);
  }

  Follower new_follower(std::uint32_t index) const {
    return {Sequence(schedule_), FollowerVehicle(model_, noise_seed_, index)};
  }

  void start_leader() {
    credit_ =
        std::make_unique<Credit>(schedule_, CreditLimits{20, 2.0, 0.1}, std::vector<std::string>{"monitor"});
  }

  void start_monitor() {
    const auto followers = followers_.size();
    attempts_seen_ = checkpoint_.attempts;
    statistics_ = std::make_unique<EnsembleStatistics>(followers, schedule_.steps);
    statistics_->merge(checkpoint_.table);
    positions_received_ = positions_at_checkpoint_;
    assembly_ = std::make_unique<Assembly>(
        schedule_, followers, TrackingError{model_.headway, model_.standstill_distance},
        checkpoint_.table.count(), checkpoint_.attempts,
        AssemblyEvents{[this](std::size_t i, const Turn& turn, const std::vector<double>& errors) {
                         statistics_->add(i, turn.step, turn.first_realization, errors);
                       },
                       [this](const CompleteBatch& batch) { commit(batch); },
                       [this] { statistics_->discard_open(); }});
  }

  void commit(const CompleteBatch& batch) {
    statistics_->commit(batch.first_realization);
    positions_received_ += batch.positions_received;
    if (!happens(0.5) && !assembly_->complete()) return;  // checkpoints are rate-limited
    checkpoint_ = {statistics_->committed(), attempts_seen_};
    positions_at_checkpoint_ = positions_received_;
  }

  void maybe_kill() {
    if (happens(troubles_.kill_leader)) {
      ++kills_;
      start_leader();
      progress_.clear();
      restart_link(to_channel_[0]);
      restart_link(to_monitor_[0]);
    }
    if (happens(troubles_.kill_follower)) {
      ++kills_;
      const std::size_t i = any(followers_.size()) + 1;
      followers_[i - 1] = new_follower(static_cast<std::uint32_t>(i));
      restart_link(
          to_channel_[i - 1]);  // the channel itself keeps nothing: what is on the way to it is on the way on
      if (i < to_channel_.size()) restart_link(to_channel_[i]);
      restart_link(to_monitor_[i]);
    }
    if (happens(troubles_.kill_monitor)) {
      ++kills_;
      start_monitor();
      for (Link& link : to_monitor_) restart_link(link);
    }
  }

  void restart_link(Link& link) {
    link.queue.clear();
    link.up_from = now_ + std::uniform_real_distribution<double>(0.0, 0.3)(chance_);
  }

  void send(Link& link, const Message& message) {
    if (now_ >= link.up_from && !happens(troubles_.drop)) link.queue.push_back(message);
  }

  void publish(std::size_t vehicle, const Turn& turn, const std::vector<double>& positions) {
    const Message message{turn, std::make_shared<const std::vector<double>>(positions)};
    send(to_monitor_[vehicle], message);
    if (vehicle < to_channel_.size()) send(to_channel_[vehicle], message);
  }

  void heartbeat() {
    next_heartbeat_ = now_ + 0.1;
    for (const Link& link : to_monitor_) {
      if (now_ < link.up_from) return;  // the monitor reports once it can hear everybody
    }
    report();
    credit_->retry_if_stalled(now_);
  }

  void report() {
    if (!happens(troubles_.drop)) progress_.push_back(assembly_->acknowledgement());
  }

  // Lets one thing happen that can: a delivery, or a step of the leader.
  bool one_event() {
    const std::size_t links = to_monitor_.size() + to_channel_.size();
    const std::size_t start = any(links + 2);
    for (std::size_t j = 0; j < links + 2; ++j) {
      const std::size_t source = (start + j) % (links + 2);
      if (source == links ? lead() : source == links + 1 ? deliver_progress() : deliver(source)) return true;
    }
    return false;
  }

  bool lead() {
    const std::optional<Turn> turn = credit_->next(now_);
    if (!turn) return false;
    const double position = turn->step == kInitialStep ? leader_.start() : leader_.step();
    publish(0, *turn, std::vector<double>(schedule_.size(turn->first_realization), position));
    return true;
  }

  bool deliver_progress() {
    if (progress_.empty()) return false;
    const Acknowledgement report = progress_.front();
    progress_.pop_front();
    credit_->acknowledge("monitor", report, now_);
    return true;
  }

  bool deliver(std::size_t source) {
    Link& link = source < to_monitor_.size() ? to_monitor_[source] : to_channel_[source - to_monitor_.size()];
    if (link.queue.empty()) return false;
    const Message message = link.queue.front();
    link.queue.pop_front();
    if (source < to_monitor_.size()) {
      observe(source, message);
    } else {
      follow(source - to_monitor_.size() + 1, message);
    }
    return true;
  }

  void observe(std::size_t vehicle, const Message& message) {
    if (assembly_->receive(vehicle, message.turn, message.positions) != Verdict::in_turn) return;
    attempts_seen_ = std::max(attempts_seen_, message.turn.attempt);
    report();
  }

  void follow(std::size_t index, const Message& message) {
    Follower& follower = followers_[index - 1];
    const Turn& turn = message.turn;
    std::vector<double> received, own;
    channels_[index - 1].transmit(turn.step, turn.first_realization, *message.positions, received);
    if (follower.sequence.receive(turn, received) != Verdict::in_turn) return;
    if (turn.step == kInitialStep) {
      follower.vehicle.start(turn.first_realization, received.size(), own);
      publish(index, turn, own);
    }
    if (schedule_.is_last_step(turn.step)) return;
    follower.vehicle.step(received, own);
    publish(index, {turn.attempt, turn.first_realization, turn.step + 1}, own);
  }

  PlatoonModel model_;
  BatchSchedule schedule_;
  std::uint64_t noise_seed_;
  Troubles troubles_;
  std::mt19937 chance_;
  LeaderVehicle leader_;
  std::unique_ptr<Credit> credit_;
  std::vector<Follower> followers_;
  std::vector<NoisyChannel> channels_;
  std::unique_ptr<EnsembleStatistics> statistics_;
  std::unique_ptr<Assembly> assembly_;
  Checkpoint checkpoint_;
  std::uint32_t attempts_seen_ = 0;
  std::uint64_t positions_received_ = 0;
  std::uint64_t positions_at_checkpoint_ = 0;
  std::vector<Link> to_monitor_;  ///< from vehicle i
  std::vector<Link> to_channel_;  ///< from vehicle i, for follower i + 1
  std::deque<Acknowledgement> progress_;
  double now_ = 0.0;             ///< [s]
  double next_heartbeat_ = 0.0;  ///< [s]
  int kills_ = 0;
};

}  // namespace platoon
