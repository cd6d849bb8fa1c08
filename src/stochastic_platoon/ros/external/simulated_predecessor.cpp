#include "stochastic_platoon/ros/external/simulated_predecessor.hpp"

#include <ros/callback_queue.h>

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

constexpr double kStartPeriod = 0.5;  // [s] between attempts to begin a run, as by a leader

}  // namespace

SimulatedPredecessor::SimulatedPredecessor(ros::NodeHandle platoon, const Configuration& configuration,
                                           std::size_t vehicle, double patience)
    : vehicle_(vehicle), platoon_(platoon), patience_(patience) {
  const VehicleModel& own = platoon::vehicle(configuration.model, vehicle);
  for (std::size_t n = 0; n < own.inputs.size(); ++n) {
    sent_inputs_.push_back(
        {own.inputs[n], platoon.advertise<Position>(received_topic(own, vehicle, n), kUnboundedQueue)});
  }
  listen(position_topic(vehicle), "m");
  if (sends_input(configuration.model, vehicle, configuration.run.followers)) listen(input_topic(vehicle), "m/s^2");
}

void SimulatedPredecessor::listen(const std::string& topic, const char* unit) {
  const boost::function<void(const PositionEvent&)> callback = [this, n = answers_.size()](const PositionEvent& event) {
    received_.emplace_back(n, event);
  };
  answers_.push_back({unit});
  answers_.back().subscriber = platoon_.subscribe<Position, const PositionEvent&>(topic, kUnboundedQueue, callback,
                                                                                  ros::VoidConstPtr(), no_delay());
}

bool SimulatedPredecessor::wait_for_vehicle(double seconds) {
  const double end = now() + seconds;
  if (!began_) began_ = now();
  while (ros::ok() && now() < end) {
    if (is_linked(answers_.front().subscriber, sent_inputs_, now() - *began_)) return true;
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
  }
  return false;
}

std::string SimulatedPredecessor::missing_links() const {
  const ros::Subscriber& position = answers_.front().subscriber;
  std::string links = position.getNumPublishers() > 0 ? "" : "publish " + position.getTopic(), inputs;
  for (const Sent& sent : sent_inputs_) {
    if (sent.publisher.getNumSubscribers() == 0) inputs += (inputs.empty() ? "" : ", ") + sent.publisher.getTopic();
  }
  if (!inputs.empty()) links += (links.empty() ? "" : " and ") + ("subscribe to " + inputs);
  return links;
}

// Repeats the first step until it is answered, as a leader does while links come up.
void SimulatedPredecessor::begin_run(const Configuration& configuration) {
  schedule_ = configuration.run.schedule();
  places_.clear();
  for (std::size_t i = 0; i <= vehicle_; ++i) places_.push_back(start_place(configuration.model, i));
  sample_period_ = configuration.model.sample_period;
  period_ = platoon_period(configuration.model.sample_period);
  platoon_.setParam("configuration", to_json(configuration).dump());
  run_ = run_identity(configuration);
  sent_.attempt = 0;
  const double end = now() + patience_;
  do {
    begin_batch(sent_.attempt + 1, 0);
    const double again = now() + kStartPeriod;
    while (is_starting() && ros::ok() && now() < again) {
      if (const std::optional<Received> answer = next(again - now())) judge(*answer);
    }
  } while (is_starting() && ros::ok() && now() < end);
}

void SimulatedPredecessor::begin_batch(std::uint32_t attempt, std::uint64_t first_realization) {
  sent_ = {attempt, first_realization, kNothingYet};
  for (Answers& answers : answers_) {
    answers.values.clear();
    answers.starting = true;
  }
  send_next();
  start_ = stamp_;
}

void SimulatedPredecessor::go_on_to(std::int64_t step) {
  wait_for_answer(sent_.step);
  while (sent_.step < step) {
    send_next();
    wait_for_answer(sent_.step);
  }
}

// Sends the next message in turn.
void SimulatedPredecessor::send_next(double shift) {
  ++sent_.step;
  stamp_ = later(stamp_, period_);
  send(sent_, run_, shift);
}

// `shift`: added to positions [m].
void SimulatedPredecessor::send(const MessageId& id, std::uint64_t run, double shift) {
  for (const Sent& sent : sent_inputs_) {
    const Position::Ptr message(new Position);
    message->header.stamp = stamp_;
    set_id(run, id, *message);
    for (std::uint64_t r = 0; r < schedule_.size(id.first_realization); ++r) {
      const double value = value_of(sent.input, id.step, id.first_realization + r);
      message->position.push_back(sent.input.signal == InputSignal::position ? value + shift : value);
    }
    sent.publisher.publish(message);
  }
}

double SimulatedPredecessor::value_of(const Input& input, std::int64_t step, std::uint64_t realization) const {
  const std::size_t source = source_of(input, vehicle_);
  if (input.signal == InputSignal::input) {
    const double phase = static_cast<double>(step) + static_cast<double>(realization);
    return step < 0 ? 0.0 : 0.1 * wobble_ * std::sin(phase);
  }
  if (input.signal == InputSignal::position) return position_of(source, step, realization);
  Signal::Recent<double> positions{};
  for (std::size_t back = 0; back < positions.size(); ++back)
    positions[back] = position_of(source, step - static_cast<std::int64_t>(back), realization);
  return difference(input.signal, sample_period_)({}, positions);
}

double SimulatedPredecessor::position_of(std::size_t source, std::int64_t step, std::uint64_t realization) const {
  if (step < 0) return places_[source];
  const auto k = static_cast<double>(step), r = static_cast<double>(realization);
  return places_[source] + speed_ * k + wobble_ * std::sin(12.9898 * (r + 1.0) + 78.233 * k);
}

bool SimulatedPredecessor::is_starting() const {
  return std::any_of(answers_.begin(), answers_.end(), [](const Answers& answers) { return answers.starting; });
}

void SimulatedPredecessor::wait_for_answer(std::int64_t step) {
  for (const Answers& answers : answers_) {
    while (answers.latest() < step) {
      const std::optional<Received> answer = next(patience_);
      if (!answer && !ros::ok()) throw std::runtime_error("interrupted: no verdict");
      if (!answer) {
        throw BrokenClause(tested_.value_or(Clause::answer),
                           here(answers, answers.latest() + 1) + formatted(": no answer within %g s", patience_));
      }
      judge(*answer);
    }
  }
}

std::optional<SimulatedPredecessor::Received> SimulatedPredecessor::next(double seconds) {
  const double end = now() + seconds;
  while (received_.empty() && ros::ok() && now() < end)
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
  if (received_.empty()) return std::nullopt;
  const Received first = received_.front();
  received_.pop_front();
  return first;
}

void SimulatedPredecessor::judge(const Received& received) {
  Answers& answers = answers_[received.first];
  const Position& message = *received.second.getConstMessage();
  std::set<std::string>& publishers = answers.publishers;
  publishers.insert(received.second.getPublisherName());
  if (publishers.size() > 1)
    throw BrokenClause(Clause::one_publisher, *publishers.begin() + " and " + *publishers.rbegin() + " publish " +
                                                  answers.subscriber.getTopic());
  const bool is_first =
      message.run == run_ && message.attempt == sent_.attempt && message.first_realization == sent_.first_realization;
  if (message.run == run_) judge_end(answers, message);
  if (answers.starting && !is_first) return;
  judge_name(answers, message);
  answers.starting = false;
  const std::string step = here(answers, message.step);
  const std::size_t size = schedule_.size(sent_.first_realization);
  if (message.position.size() != size)
    throw BrokenClause(
        Clause::size, step + ": " + std::to_string(message.position.size()) + " positions, of " + std::to_string(size));
  if (!all_finite(message.position)) throw BrokenClause(Clause::finite, step + ": a NaN or an infinity");
  if (message.step == kInitialStep && received.first == 0) judge_start(message);
  ros::Time due = start_;
  for (std::int64_t k = kInitialStep; k < message.step; ++k) due = later(due, period_);
  if (message.header.stamp != due)
    throw BrokenClause(Clause::stamp,
                       step + formatted(": stamp %.9f s, of %.9f s", message.header.stamp.toSec(), due.toSec()));
  answers.values[message.step] = message.position;
}

// Throws BrokenClause for a step beyond the last of its batch, which may be an earlier one.
void SimulatedPredecessor::judge_end(const Answers& answers, const Position& message) const {
  if (schedule_.endless() || message.step < schedule_.steps) return;
  throw BrokenClause(Clause::turn,
                     place(answers, id_of(message)) + ": the last step is " + std::to_string(schedule_.steps - 1));
}

// Throws BrokenClause if the message is not the one that is due.
void SimulatedPredecessor::judge_name(const Answers& answers, const Position& message) const {
  const std::string due = here(answers, answers.latest() + 1) + " was due, and came: ";
  if (message.run != run_)
    throw BrokenClause(tested_.value_or(Clause::run), due + formatted("a message of run %016llx instead of %016llx",
                                                                      static_cast<unsigned long long>(message.run),
                                                                      static_cast<unsigned long long>(run_)));
  if (message.attempt != sent_.attempt)
    throw BrokenClause(tested_.value_or(Clause::attempt), due + "attempt " + std::to_string(message.attempt) +
                                                              " instead of " + std::to_string(sent_.attempt));
  const bool is_due = message.first_realization == sent_.first_realization && message.step == answers.latest() + 1;
  if (!is_due || message.step > sent_.step + 1)
    throw BrokenClause(tested_.value_or(Clause::turn), due + "step " + std::to_string(message.step) +
                                                           " of the realizations from " +
                                                           std::to_string(message.first_realization));
}

void SimulatedPredecessor::judge_start(const Position& message) const {
  constexpr double kRounding = 1e-6;  // [m]
  for (const double position : message.position) {
    if (std::abs(position - places_.back()) > kRounding)
      throw BrokenClause(Clause::start_anew,
                         here(answers_.front(), kInitialStep) +
                             formatted(": at %g m, of %g m, its initial position", position, places_.back()));
  }
}

// With the topic where the answer is no position.
std::string SimulatedPredecessor::place(const Answers& answers, const MessageId& id) const {
  return (&answers == &answers_.front() ? "" : answers.subscriber.getTopic() + ": ") + "step " +
         std::to_string(id.step) + " of the realizations from " + std::to_string(id.first_realization) + ", attempt " +
         std::to_string(id.attempt);
}

std::string SimulatedPredecessor::here(const Answers& answers, std::int64_t step) const {
  return place(answers, {sent_.attempt, sent_.first_realization, step});
}

}  // namespace platoon
