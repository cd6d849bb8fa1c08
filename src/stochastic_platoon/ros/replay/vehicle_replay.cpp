#include "stochastic_platoon/ros/replay/vehicle_replay.hpp"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <tuple>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/progress_reports.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;
using stochastic_platoon::Progress;

namespace {

// Selects the recorded topic of this name, whatever the namespace of the recording.
std::function<bool(const PlatoonTopic&)> only(const std::string& name) {
  return [sought = parse_topic("/" + name).value()](const PlatoonTopic& topic) { return topic.key() == sought.key(); };
}

// The next message; none at the end.
Position::Ptr next_of(BagStream& stream) {
  const std::optional<RecordedMessage> message = stream.next();
  return message ? message->position() : nullptr;
}

// The limits of a leader with one follower.
CreditLimits limits_of(const RunOptions& run) {
  constexpr double kFirstStep = 0.1;     // [s]
  constexpr double kPerPosition = 5e-7;  // [s]
  const double sought = kFirstStep + kPerPosition * static_cast<double>(run.batch);
  return {run.window, run.stall_timeout, run.stall_timeout > 0.0 ? std::min(sought, run.stall_timeout) : sought};
}

std::string its_clause(Clause clause) {
  return "; the vehicle is external: " + named(clause);
}

bool is_of(const MessageId& id, const Position& message) {
  return std::tie(id.attempt, id.first_realization, id.step) ==
         std::tie(message.attempt, message.first_realization, message.step);
}

}  // namespace

VehicleReplay::VehicleReplay(ros::NodeHandle platoon, const Configuration& configuration, const BagSource& bags,
                             std::size_t vehicle, bool external, double patience)
    : name_(vehicle_name(vehicle)),
      run_(run_identity(configuration)),
      external_(external),
      patience_(patience),
      bags_(bags),
      vehicle_(vehicle),
      credit_(limits_of(configuration.run)),
      notice_senders_(platoon, configuration.model) {
  if (vehicle < 1 || vehicle > configuration.run.followers) {
    throw std::invalid_argument("vehicle: " + std::to_string(vehicle) +
                                ": must be a follower of the recording, from 1 to " +
                                std::to_string(configuration.run.followers));
  }
  const VehicleModel& own = platoon::vehicle(configuration.model, vehicle);
  for (std::size_t n = 0; n < own.inputs.size(); ++n) {
    const std::string topic = received_topic(own, vehicle, n);
    sent_.push_back({topic, platoon.advertise<Position>(topic, kUnboundedQueue)});
  }
  if (!(patience > 0.0)) throw std::invalid_argument("patience: " + std::to_string(patience) + ": must be above 0 [s]");
  listen(platoon, position_topic(vehicle), "positions", "m");
  if (sends_input(configuration.model, vehicle, configuration.run.followers))
    listen(platoon, input_topic(vehicle), "inputs", "m/s^2");
  open();
  if (answers_.size() > 1 && !answers_.back().expected) answers_.pop_back();  // another program recorded no inputs
  if (!answers_.front().expected) throw std::runtime_error("bags: hold no position of " + name_);
  progress_ = platoon.subscribe(kProgressTopic, kUnboundedQueue, &VehicleReplay::receive_notice, this);
  timer_ = platoon.createSteadyTimer(ros::WallDuration(0.02), [this](const auto&) { play(); });
}

void VehicleReplay::listen(ros::NodeHandle& platoon, const std::string& topic, const char* noun, const char* unit) {
  const std::string resolved = platoon.resolveName(topic);
  answers_.push_back({topic, noun, unit, SolePublisher(resolved, external_ ? its_clause(Clause::one_publisher) : ""),
                      MessageCounter(resolved, external_ ? name_ : "")});
  Answers& answers = answers_.back();
  const boost::function<void(const PositionEvent&)> callback = [this, &answers](const PositionEvent& event) {
    receive(answers, event);
  };
  answers.subscriber = platoon.subscribe<Position, const PositionEvent&>(topic, kUnboundedQueue, callback,
                                                                         ros::VoidConstPtr(), no_delay());
}

// Opens the bag at the beginning of the batch that is due.
void VehicleReplay::open() {
  for (Sent& sent : sent_) sent.stream.emplace(bags_, only(sent.topic));
  read_next();
  for (std::int64_t n = 0; n < credit_.upcoming(); ++n) read_next();
  for (Answers& answers : answers_) {
    answers.stream.emplace(bags_, only(answers.topic));
    answers.expected = next_of(*answers.stream);
    for (std::int64_t n = 0; n < batch_start_; ++n) answers.expected = next_of(*answers.stream);
    answers.compared = batch_start_;
  }
}

// A recorder writes the streams step by step, so that their messages correspond.
void VehicleReplay::read_next() {
  for (Sent& sent : sent_) sent.next = next_of(*sent.stream);
}

void VehicleReplay::play() {
  if (done_) return;
  const bool linked = is_linked();
  check_patience();
  if (!linked || done_) return;
  if (credit_.retry_if_stalled(now())) begin_again();
  send_allowed();
}

bool VehicleReplay::is_linked() {
  if (!began_) began_ = now();
  const double waited = now() - *began_;
  const bool linked = platoon::is_linked(answers_.front().subscriber, sent_, waited);
  if (!linked && !waiting_ && waited >= kLinkTime) {
    ROS_INFO_STREAM("waiting for " << (external_ ? "external " : "") << name_ << (external_ ? ": start its node" : "")
                                   << formatted(" (the replay ends after %g s)", patience_));
    waiting_ = true;
  }
  return linked;
}

void VehicleReplay::check_patience() {
  const double since = std::max(*began_, credit_.last_progress());
  if (now() - since > patience_) end_with(silence());
}

void VehicleReplay::send_allowed() {
  while (!done_ && sent_.front().next && credit_.may_send()) {
    const MessageId id = id_of(*sent_.front().next);
    for (const Sent& sent : sent_) {
      if (!sent.next) return end_with("the bag holds fewer messages of one of its inputs than of another");
      if (!is_of(id, *sent.next)) return end_with("the bag holds inputs of different steps");
    }
    credit_.send(id.step == kInitialStep, now());
    for (const Sent& sent : sent_) {
      sent.next->run = run_;
      sent.next->attempt += attempts_ahead_;
      last_attempt_ = std::max(last_attempt_, sent.next->attempt);
      sent.publisher.publish(sent.next);
    }
    read_next();
  }
}

void VehicleReplay::begin_again() {
  open();
  const Position::Ptr& first = sent_.front().next;
  if (!first || !last_behind().expected) return end_with("the bag has changed while it was replayed");
  if (last_attempt_ >= kLastAttempt || first->attempt > last_attempt_)
    return end_with(formatted("%s: attempt %u is followed by none", name_.c_str(), last_attempt_));
  attempts_ahead_ = last_attempt_ + 1 - first->attempt;
  ROS_DEBUG_STREAM(name_ << ": attempt " << last_attempt_ + 1 << " begins");
}

// The answers of which the fewest have been compared.
const VehicleReplay::Answers& VehicleReplay::last_behind() const {
  return *std::min_element(answers_.begin(), answers_.end(),
                           [](const Answers& one, const Answers& other) { return one.compared < other.compared; });
}

MessageId VehicleReplay::expected_id(const Answers& answers) const {
  MessageId id = id_of(*answers.expected);
  id.attempt += attempts_ahead_;
  return id;
}

void VehicleReplay::receive(Answers& answers, const PositionEvent& event) {
  const Position& live = *event.getMessage();
  if (done_) return;
  if (live.run != run_) return answers.counter.drop(DropReason::foreign_run, id_of(live), live.position.size());
  if (answers.publisher.admits(event.getConnectionHeaderPtr(), live.run) && answers.expected) judge(answers, live);
}

// Why an answer does not count; none if it is due. A built-in vehicle of another size, or with a NaN, differs.
DropReason VehicleReplay::fault_of(const Answers& answers, const Position& live) const {
  if (live.attempt < expected_id(answers).attempt) return DropReason::stale;
  if (!is_of(expected_id(answers), live)) return DropReason::out_of_turn;
  if (external_ && live.position.size() != answers.expected->position.size()) return DropReason::wrong_size;
  return external_ && !all_finite(live.position) ? DropReason::not_finite : DropReason::none;
}

// A fault at the answer that is due, or after it, shows that the latter is lost. The attempt may grow between recorded
// batches.
void VehicleReplay::judge(Answers& answers, const Position& live) {
  const MessageId id = id_of(live), due = expected_id(answers);
  const auto place = [](const MessageId& of) { return std::tie(of.attempt, of.first_realization, of.step); };
  const DropReason fault = fault_of(answers, live);
  if (fault != DropReason::none) {
    const std::optional<DropReason> breach = answers.counter.latest_breach();
    const bool due_dropped = breach == DropReason::wrong_size || breach == DropReason::not_finite;
    if (!due_dropped || fault != DropReason::out_of_turn)  // else the fault is the one before
      answers.counter.drop(fault, id, live.position.size());
    if (place(id) < place(due)) return;
    if (credit_.give_up(now())) begin_again();
    return send_allowed();
  }
  compare(answers, live);
  done_ = !difference_.empty();
  if (done_) return;
  answers.counter.take(id);
  const std::int64_t before = last_behind().compared;
  ++answers.compared;
  answers.expected = next_of(*answers.stream);
  if (last_behind().compared == before) return;  // the step lacks another answer
  if (id.step == kInitialStep) batch_start_ = before;
  credit_.answer(id.step == kInitialStep, now());
  done_ = !last_behind().expected;
  if (done_ && std::any_of(answers_.begin(), answers_.end(), [](const Answers& of) { return of.expected; }))
    end_with("the bag holds fewer messages of one of its answers than of another");
  send_allowed();
}

void VehicleReplay::receive_notice(const ros::MessageEvent<const Progress>& event) {
  const Progress& notice = *event.getConstMessage();
  const bool missed = notice.receiver == name_ && notice.run == run_ && notice.attempt == last_attempt_ &&
                      notice.notice == Progress::MISSED;
  if (!missed || done_ || !notice_senders_.admits(event)) return;
  if (credit_.give_up(now())) begin_again();
  send_allowed();
}

void VehicleReplay::end_with(const std::string& reason) {
  reason_ = reason;
  done_ = true;
}

// The reason why there is no verdict.
std::string VehicleReplay::silence() const {
  const std::string external_hint =
      external_ ? "; the vehicle is external: start its node, and allow it more time with patience:=SECONDS" : "";
  for (const Answers& answers : answers_) {
    if (answers.subscriber.getNumPublishers() == 0)
      return name_ + " is not running: no publisher of " + answers.subscriber.getTopic() + external_hint;
  }
  for (const Sent& sent : sent_) {
    if (sent.publisher.getNumSubscribers() == 0)
      return name_ + " is not running: no subscriber of " + sent.publisher.getTopic() + external_hint;
  }
  const Answers& behind = last_behind();
  const MessageId due = expected_id(behind);
  const std::optional<DropReason> breach = behind.counter.latest_breach();
  const std::string what = breach ? std::string("; its last message was dropped, as ") + to_string(*breach) : "";
  return name_ +
         formatted(" has not answered step %lld of the realizations from %llu%s within %g s, in %u attempts",
                   static_cast<long long>(due.step), static_cast<unsigned long long>(due.first_realization),
                   &behind == &answers_.front() ? "" : (" on " + behind.topic).c_str(), patience_,
                   credit_.repetitions() + 1) +
         what + "; " + named(breach ? *broken_clause(*breach) : Clause::answer);
}

void VehicleReplay::compare(Answers& answers, const Position& live) {
  const Position& recorded = *answers.expected;
  const bool same_size = live.position.size() == recorded.position.size();
  const std::size_t bytes = recorded.position.size() * sizeof(double);
  if (same_size && std::memcmp(live.position.data(), recorded.position.data(), bytes) == 0) return;
  if (same_size && external_) {
    for (std::size_t r = 0; r < recorded.position.size(); ++r)
      answers.largest = std::max(answers.largest, std::abs(live.position[r] - recorded.position[r]));
    return;
  }
  difference_ = formatted("step %lld of the realizations from %llu", static_cast<long long>(recorded.step),
                          static_cast<unsigned long long>(recorded.first_realization));
  std::size_t r = 0;
  while (same_size && r + 1 < live.position.size() && live.position[r] == recorded.position[r]) ++r;
  if (same_size)
    difference_ += formatted(": realization %zu is at %.17g %s, was at %.17g %s", r, live.position[r], answers.unit,
                             recorded.position[r], answers.unit);
}

std::string VehicleReplay::verdict() const {
  if (!reason_.empty()) return "no verdict: " + reason_;
  if (!difference_.empty()) return name_ + " differs from the recording at " + difference_;
  std::string apart;
  for (const Answers& of : answers_) {
    if (of.largest != 0.0) apart += formatted(", %s at most %.3g %s apart", of.noun, of.largest, of.unit);
  }
  const std::string others = answers_.size() > 1 ? std::string(", and its ") + answers_.back().noun : "";
  return name_ + formatted(": %lld messages", static_cast<long long>(answers_.front().compared)) +
         (apart.empty() ? " equal the recorded ones to the bit" + others : " as in the recording" + apart);
}

}  // namespace platoon
