#include "unit/run/delivery/lossy_graph.hpp"

#include <algorithm>
#include <stdexcept>

#include "unit/transmitted.hpp"

namespace platoon {

LossyGraph::LossyGraph(const PlatoonModel& model, const BatchSchedule& schedule, std::size_t followers,
                       std::uint64_t noise_seed, const Troubles& troubles, unsigned chance)
    : model_(model),
      schedule_(schedule),
      noise_seed_(noise_seed),
      troubles_(troubles),
      chance_(chance),
      leader_(model),
      checkpoint_{EnsembleTotals(SignalCells{followers, schedule.steps}), 0, 0},
      to_channel_(followers),
      to_monitor_(followers + 1),
      to_recorder_(troubles.recorder ? followers + 1 : 0) {
  for (std::uint32_t i = 1; i <= followers; ++i) {
    followers_.push_back(new_follower(i));
    channels_.emplace_back(model.default_vehicle().position().noise_variance, noise_seed, i);
  }
  start_leader();
  start_monitor();
  start_recorder();
}

const EnsembleTotals& LossyGraph::run() {
  for (std::int64_t event = 0; !credit_->complete(); ++event) {
    if (event > 3000000) throw std::runtime_error("the run does not end");
    now_ += 0.001;
    maybe_kill();
    if (now_ >= next_heartbeat_) heartbeat();
    if (!any_event()) now_ += 0.02;
  }
  return *statistics_->totals();
}

LossyGraph::Follower LossyGraph::new_follower(std::uint32_t index) const {
  return {MessageOrder(schedule_), FollowerVehicle(model_, noise_seed_, index),
          publishes_ahead(index, to_channel_.size(), troubles_.pipeline_depth)};
}

void LossyGraph::start_leader() {
  std::vector<std::string> receivers{"monitor"};
  if (troubles_.recorder) receivers.emplace_back("recorder");
  credit_ = std::make_unique<Credit>(schedule_, CreditLimits{kWindow, 2.0, 0.1}, receivers);
}

void LossyGraph::start_monitor() {
  monitor_pace_ = ReportPace(schedule_, kWindow);
  attempts_seen_ = checkpoint_.attempts;
  positions_received_ = checkpoint_.positions_received;
  statistics_ = std::make_unique<EnsembleStatistics>(SignalCells{followers_.size(), schedule_.steps});
  statistics_->merge(checkpoint_.totals);
  assembly_ =
      std::make_unique<SignalAssembly>(schedule_, followers_.size(), checkpoint_.totals.count(), checkpoint_.attempts);
}

void LossyGraph::commit(const CompleteBatch& batch) {
  statistics_->commit(batch.first_realization);
  positions_received_ += batch.positions_received;
  if (!happens(0.5) && !assembly_->arrivals().complete()) return;  // checkpoints are rate-limited
  checkpoint_ = {*statistics_->totals(), attempts_seen_, positions_received_};
}

void LossyGraph::start_recorder() {
  recorder_pace_ = ReportPace(schedule_, kWindow);
  const std::uint64_t first = recorded_.empty() ? 0 : schedule_.next(recorded_.back());
  recorder_ = std::make_unique<Arrivals>(schedule_, followers_.size() + 1, first, 0);
}

void LossyGraph::maybe_kill() {
  if (happens(troubles_.kill_leader)) {
    ++kills_;
    start_leader();
    progress_.clear();
    restart_vehicle_links(0);
  }
  if (happens(troubles_.kill_follower)) {
    ++kills_;
    const std::size_t i = any(followers_.size()) + 1;
    followers_[i - 1] = new_follower(static_cast<std::uint32_t>(i));
    restart_link(to_channel_[i - 1]);  // the channel has no state: one link models the way through it
    restart_vehicle_links(i);
  }
  if (happens(troubles_.kill_monitor)) {
    ++kills_;
    start_monitor();
    for (Link& link : to_monitor_) restart_link(link);
  }
  if (happens(troubles_.kill_recorder)) {
    ++kills_;
    start_recorder();
    for (Link& link : to_recorder_) restart_link(link);
  }
}

void LossyGraph::restart_link(Link& link) {
  link.queue.clear();
  link.up_from = now_ + std::uniform_real_distribution<double>(0.0, 0.1)(chance_);
}

void LossyGraph::restart_vehicle_links(std::size_t vehicle) {
  for (std::vector<Link>* links : {&to_channel_, &to_monitor_, &to_recorder_}) {
    if (vehicle < links->size()) restart_link((*links)[vehicle]);
  }
}

void LossyGraph::publish(std::size_t vehicle, const MessageId& id, const std::vector<double>& positions) {
  const Message message{id, std::make_shared<const std::vector<double>>(positions)};
  for (std::vector<Link>* links : {&to_channel_, &to_monitor_, &to_recorder_}) {
    if (vehicle >= links->size()) continue;
    Link& link = (*links)[vehicle];
    if (now_ >= link.up_from && !happens(troubles_.drop)) link.queue.push_back(message);
  }
}

bool LossyGraph::all_up(const std::vector<Link>& links) const {
  return std::all_of(links.begin(), links.end(), [this](const Link& link) { return now_ >= link.up_from; });
}

void LossyGraph::heartbeat() {
  next_heartbeat_ = now_ + 0.1;
  if (all_up(to_monitor_)) report("monitor", assembly_->arrivals(), monitor_pace_);
  if (troubles_.recorder && all_up(to_recorder_)) report("recorder", *recorder_, recorder_pace_);
  credit_->retry_if_stalled(now_);
}

void LossyGraph::report(const char* receiver, const Arrivals& arrivals, ReportPace& pace) {
  pace.note_report(arrivals.acknowledgement());
  if (!happens(troubles_.drop)) progress_.push_back({receiver, arrivals.acknowledgement(), arrivals.messages()});
}

void LossyGraph::report_if_due(const char* receiver, const Arrivals& arrivals, ReportPace& pace) {
  if (pace.is_due(arrivals.acknowledgement())) report(receiver, arrivals, pace);
}

bool LossyGraph::any_event() {
  const std::size_t kinds = to_channel_.size() + to_monitor_.size() + to_recorder_.size() + 2;
  const std::size_t start = any(kinds);
  for (std::size_t j = 0; j < kinds; ++j) {
    if (event((start + j) % kinds)) return true;
  }
  return false;
}

bool LossyGraph::event(std::size_t kind) {
  if (kind < to_channel_.size()) {
    return deliver(to_channel_[kind], [&](const Message& message) { follow(kind + 1, message); });
  }
  kind -= to_channel_.size();
  if (kind < to_monitor_.size()) {
    return deliver(to_monitor_[kind], [&](const Message& message) { observe(kind, message); });
  }
  kind -= to_monitor_.size();
  if (kind < to_recorder_.size()) {
    return deliver(to_recorder_[kind], [&](const Message& message) { record(kind, message); });
  }
  return kind == to_recorder_.size() ? lead() : deliver_progress();
}

bool LossyGraph::deliver_progress() {
  if (progress_.empty()) return false;
  const Report report = progress_.front();
  progress_.pop_front();
  credit_->acknowledge(report.receiver, report.acknowledgement, now_, report.messages);
  return true;
}

bool LossyGraph::lead() {
  const std::optional<MessageId> id = credit_->next(now_);
  if (!id) return false;
  const double position = id->step == kInitialStep ? leader_.start() : leader_.step();
  publish(0, *id, std::vector<double>(schedule_.size(id->first_realization), position));
  return true;
}

void LossyGraph::follow(std::size_t index, const Message& message) {
  Follower& follower = followers_[index - 1];
  const MessageId& id = message.id;
  std::vector<double> own;
  const std::vector<double> received =
      transmitted(channels_[index - 1], id.step, id.first_realization, *message.positions);
  if (follower.order.receive({id, received.size(), true}) != DropReason::none) return;
  if (id.step == kInitialStep) {
    follower.vehicle.start(id.first_realization, received.size(), own);
    publish(index, id, own);
  } else if (!follower.is_ahead) {
    publish(index, id, follower.upcoming);
  }
  if (schedule_.is_last_step(id.step)) return;
  follower.vehicle.step(received, own);
  if (follower.is_ahead) {
    publish(index, {id.attempt, id.first_realization, id.step + 1}, own);
  } else {
    follower.upcoming = own;
  }
}

void LossyGraph::observe(std::size_t vehicle, const Message& message) {
  const SignalAssembly::Receipt receipt = assembly_->receive(vehicle, descriptor(message), message.positions);
  if (receipt.restarted) statistics_->restart();
  if (receipt.drop != DropReason::none) return;
  for (const DueSignals& due : receipt.due) add_errors(due);
  attempts_seen_ = std::max(attempts_seen_, message.id.attempt);
  const std::optional<CompleteBatch> batch = assembly_->settle(vehicle, descriptor(message));
  if (batch) commit(*batch);
  report_if_due("monitor", assembly_->arrivals(), monitor_pace_);
}

void LossyGraph::add_errors(const DueSignals& due) {
  const Signal error = tracking_error(model_, 1);
  std::vector<double> errors(due.own[0]->size());
  error(due.predecessor->data(), {due.own[0]->data(), due.own[1]->data()}, errors.size(), errors.data());
  const auto in_place = [&errors](std::size_t offset, std::size_t, double*) {
    return static_cast<const double*>(errors.data() + offset);
  };
  statistics_->add({due.follower,
                    due.id.step,
                    due.id.first_realization,
                    errors.size(),
                    {reduce_batch(due.id.first_realization, errors.size(), in_place)}});
}

void LossyGraph::record(std::size_t vehicle, const Message& message) {
  if (recorder_->admit(vehicle, descriptor(message)) != DropReason::none) return;
  const std::optional<CompleteBatch> batch = recorder_->count(vehicle, descriptor(message));
  if (batch) recorded_.push_back(batch->first_realization);
  report_if_due("recorder", *recorder_, recorder_pace_);
}

}  // namespace platoon
