#include "stochastic_platoon/ros/external/vehicle_check.hpp"

#include <ros/callback_queue.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

constexpr double kStartPeriod = 0.5;  // [s] between attempts to begin a run, as by a leader

struct Broken : std::runtime_error {
  Broken(Clause of, const std::string& text) : std::runtime_error(text), clause(of) {}
  Clause clause;
};

// Position of the simulated predecessor [m]: it drives off, differently in each realization.
double predecessor_at(std::int64_t step, std::uint64_t realization) {
  if (step < 0) return 0.0;
  const auto k = static_cast<double>(step), r = static_cast<double>(realization);
  return 2.0 * k + 0.5 * std::sin(12.9898 * (r + 1.0) + 78.233 * k);
}

bool same_bits(const std::vector<double>& one, const std::vector<double>& other) {
  return one.size() == other.size() && std::memcmp(one.data(), other.data(), one.size() * sizeof(double)) == 0;
}

}  // namespace

VehicleCheck::VehicleCheck(ros::NodeHandle platoon, const Configuration& present, const Configuration& next,
                           std::size_t vehicle, double patience)
    : platoon_(platoon),
      present_(present),
      next_(next),
      name_(vehicle_name(vehicle)),
      vehicle_(vehicle),
      patience_(patience),
      schedule_(present.run.schedule()),
      period_(platoon_period(present.model.sample_period)),
      predecessor_position_(platoon.advertise<Position>(predecessor_position_topic(vehicle), kUnboundedQueue)) {
  const boost::function<void(const PositionEvent&)> callback = [this](const PositionEvent& event) {
    received_.push_back({event.getMessage(), event.getPublisherName()});
  };
  position_ = platoon.subscribe<Position, const PositionEvent&>(position_topic(vehicle), kUnboundedQueue, callback,
                                                                ros::VoidConstPtr(), no_delay());
}

bool VehicleCheck::wait_for_vehicle(double seconds) {
  const double end = now() + seconds;
  while (ros::ok() && now() < end) {
    if (position_.getNumPublishers() > 0 && predecessor_position_.getNumSubscribers() > 0) return true;
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
  }
  return false;
}

std::optional<VehicleCheck::Breach> VehicleCheck::run(const Holds& holds) {
  const std::vector<std::pair<void (VehicleCheck::*)(), std::vector<Clause>>> parts = {
      {&VehicleCheck::check_publishers, {Clause::one_publisher}},
      {&VehicleCheck::check_batches, {Clause::answer, Clause::size, Clause::finite, Clause::stamp}},
      {&VehicleCheck::check_turn, {Clause::turn}},
      {&VehicleCheck::check_attempts, {Clause::attempt}},
      {&VehicleCheck::check_repetition, {Clause::start_anew, Clause::causal}},
      {&VehicleCheck::check_queues, {Clause::queues}},
      {&VehicleCheck::check_runs, {Clause::run}},
  };
  try {
    for (const auto& part : parts) {
      tested_.reset();
      (this->*part.first)();
      for (const Clause clause : part.second) holds(clause);
    }
  } catch (const Broken& error) {
    return Breach{error.clause, error.what()};
  }
  return std::nullopt;
}

void VehicleCheck::check_publishers() {
  const std::vector<std::string> names = registered_publishers(position_.getTopic());
  if (names.size() > 1)
    broken(Clause::one_publisher, names[0] + " and " + names[1] + " publish " + position_.getTopic());
}

void VehicleCheck::check_batches() {
  begin_run(present_);
  go_on_to(schedule_.steps - 1);
  begin_batch(sent_.attempt, schedule_.next(0));
  go_on_to(schedule_.steps - 1);
}

void VehicleCheck::check_turn() {
  begin_batch(sent_.attempt + 1, 0);
  go_on_to(10);
  tested_ = Clause::turn;
  send(sent_, run_);  // repeated
  send({sent_.attempt, 0, kInitialStep}, run_);
  go_on_to(11);
  send({sent_.attempt, 0, 14}, run_);  // beyond the next
  go_on_to(12);
}

void VehicleCheck::check_attempts() {
  tested_ = Clause::attempt;
  begin_batch(sent_.attempt + 1, 0);
  go_on_to(3);
  send({sent_.attempt - 1, 0, 4}, run_);
  go_on_to(4);
  send({sent_.attempt - 1, 0, kInitialStep}, run_);
  go_on_to(5);
  send({sent_.attempt + 3, 0, 6}, run_);  // its start was missed
  go_on_to(6);
  begin_batch(sent_.attempt + 4, 0);
  go_on_to(3);
}

// A repeated batch must give the same answers up to the step at which its messages differ.
void VehicleCheck::check_repetition() {
  constexpr std::int64_t kUntil = 20;
  const auto answers_with = [this](double shift) {
    begin_batch(sent_.attempt + 1, 0);
    go_on_to(kUntil - 1);
    send_next(shift);
    wait_for_answer(kUntil);
    return answers_;
  };
  const std::map<std::int64_t, std::vector<double>> first = answers_with(0.0), second = answers_with(1.0);
  for (std::int64_t step = kInitialStep; step <= kUntil; ++step) {
    if (same_bits(first.at(step), second.at(step))) continue;
    std::size_t r = 0;
    while (first.at(step)[r] == second.at(step)[r] && r + 1 < first.at(step).size()) ++r;
    const std::string what =
        here(step) + formatted(": realization %zu at %.17g m, after the same messages at %.17g m before", r,
                               second.at(step)[r], first.at(step)[r]);
    if (step < kUntil) broken(Clause::start_anew, what);
    broken(Clause::causal, what + ": it depends on the message of the same step");
  }
}

void VehicleCheck::check_queues() {
  begin_batch(sent_.attempt + 1, 0);
  tested_ = Clause::queues;
  while (sent_.step < schedule_.steps - 1) send_next();
  wait_for_answer(sent_.step);
}

void VehicleCheck::check_runs() {
  begin_batch(sent_.attempt + 1, 0);
  go_on_to(3);
  tested_ = Clause::run;
  send({sent_.attempt, 0, 4}, run_ ^ 1);  // of an unknown run
  go_on_to(4);
  const std::uint64_t before = run_;
  const std::uint32_t attempt = sent_.attempt;
  begin_run(next_);
  go_on_to(5);
  send({attempt, 0, 6}, before);
  send({attempt + 1, 0, 6}, before);
  send({sent_.attempt, 0, 6}, before);
  go_on_to(schedule_.steps - 1);
  check_publishers();
}

// Repeats the first step until it is answered, as a leader does while links come up.
void VehicleCheck::begin_run(const Configuration& configuration) {
  platoon_.setParam("configuration", to_json(configuration).dump());
  run_ = run_identity(configuration);
  sent_.attempt = 0;
  const double end = now() + patience_;
  do {
    begin_batch(sent_.attempt + 1, 0);
    const double again = now() + kStartPeriod;
    while (starting_ && ros::ok() && now() < again) {
      if (const std::optional<Received> answer = next(again - now())) judge(*answer);
    }
  } while (starting_ && ros::ok() && now() < end);
}

void VehicleCheck::begin_batch(std::uint32_t attempt, std::uint64_t first_realization) {
  sent_ = {attempt, first_realization, kNothingYet};
  answered_ = kNothingYet;
  starting_ = true;
  answers_.clear();
  send_next();
  start_ = stamp_;
}

void VehicleCheck::go_on_to(std::int64_t step) {
  wait_for_answer(sent_.step);
  while (sent_.step < step) {
    send_next();
    wait_for_answer(sent_.step);
  }
}

// Sends the next message in turn.
void VehicleCheck::send_next(double shift) {
  ++sent_.step;
  stamp_ = later(stamp_, period_);
  send(sent_, run_, shift);
}

void VehicleCheck::send(const MessageId& id, std::uint64_t run, double shift) {
  const Position::Ptr message(new Position);
  message->header.stamp = stamp_;
  set_id(run, id, *message);
  for (std::uint64_t r = 0; r < schedule_.size(id.first_realization); ++r)
    message->position.push_back(predecessor_at(id.step, id.first_realization + r) + shift);
  predecessor_position_.publish(message);
}

void VehicleCheck::wait_for_answer(std::int64_t step) {
  while (answered_ < step) {
    const std::optional<Received> answer = next(patience_);
    if (!answer) {
      broken(tested_.value_or(Clause::answer), here(answered_ + 1) + formatted(": no answer within %g s", patience_));
    }
    judge(*answer);
  }
}

std::optional<VehicleCheck::Received> VehicleCheck::next(double seconds) {
  const double end = now() + seconds;
  while (received_.empty() && ros::ok() && now() < end)
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
  if (received_.empty()) return std::nullopt;
  const Received first = received_.front();
  received_.pop_front();
  return first;
}

void VehicleCheck::judge(const Received& received) {
  const Position& message = *received.message;
  publishers_.insert(received.publisher);
  if (publishers_.size() > 1)
    broken(Clause::one_publisher,
           *publishers_.begin() + " and " + *publishers_.rbegin() + " publish " + position_.getTopic());
  const bool is_first =
      message.run == run_ && message.attempt == sent_.attempt && message.first_realization == sent_.first_realization;
  if (starting_ && !is_first) return;
  judge_name(message);
  starting_ = false;
  const std::string step = here(message.step);
  const std::size_t size = schedule_.size(sent_.first_realization);
  if (message.position.size() != size)
    broken(Clause::size,
           step + ": " + std::to_string(message.position.size()) + " positions, of " + std::to_string(size));
  if (!all_finite(message.position)) broken(Clause::finite, step + ": a NaN or an infinity");
  ros::Time due = start_;
  for (std::int64_t k = kInitialStep; k < message.step; ++k) due = later(due, period_);
  if (message.header.stamp != due)
    broken(Clause::stamp, step + formatted(": stamp %.9f s, of %.9f s", message.header.stamp.toSec(), due.toSec()));
  answered_ = message.step;
  answers_[message.step] = message.position;
}

// Throws Broken if the message is not the one that is due.
void VehicleCheck::judge_name(const Position& message) const {
  const std::string due = here(answered_ + 1) + " was due, and came: ";
  if (message.run != run_)
    broken(tested_.value_or(Clause::run),
           due + formatted("a message of run %016llx instead of %016llx", static_cast<unsigned long long>(message.run),
                           static_cast<unsigned long long>(run_)));
  if (message.attempt != sent_.attempt)
    broken(tested_.value_or(Clause::attempt),
           due + "attempt " + std::to_string(message.attempt) + " instead of " + std::to_string(sent_.attempt));
  const bool is_due = message.first_realization == sent_.first_realization && message.step == answered_ + 1;
  if (!is_due || message.step > sent_.step + 1)
    broken(tested_.value_or(Clause::turn), due + "step " + std::to_string(message.step) + " of the realizations from " +
                                               std::to_string(message.first_realization));
}

void VehicleCheck::broken(Clause clause, const std::string& what) const {
  throw Broken(clause, what);
}

std::string VehicleCheck::here(std::int64_t step) const {
  return "step " + std::to_string(step) + " of the realizations from " + std::to_string(sent_.first_realization) +
         ", attempt " + std::to_string(sent_.attempt);
}

}  // namespace platoon
