#include "stochastic_platoon/ros/external/vehicle_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/settling_time.hpp"
#include "stochastic_platoon/ros/transport/publishers.hpp"

namespace platoon {

namespace {

constexpr double kMoreDistance = 5.0;  // [m]
constexpr double kSpeed = 20.0;        // of the predecessor behind which spacings are checked [m/s]

bool same_bits(const std::vector<double>& one, const std::vector<double>& other) {
  return one.size() == other.size() && std::memcmp(one.data(), other.data(), one.size() * sizeof(double)) == 0;
}

// A larger standstill distance, and another headway where the loop takes one and the vehicle hears its predecessor
// alone. The first candidate is larger, too, so that the changes of the distance add up; it may leave a loop unstable
// that is not normalised by 1 + h.
void space_otherwise(VehicleModel& vehicle) {
  vehicle.standstill_distance += kMoreDistance;
  if (!vehicle.design || !vehicle.hears_predecessor_only()) return;
  for (const double headway : {1.25 * vehicle.headway + 1.0, 1.05 * vehicle.headway}) {
    const ClosedLoop loop = close_loop(*vehicle.design, headway);
    if (spectral_radius(loop) >= 1.0) continue;
    vehicle.headway = headway;
    vehicle.loop = loop;
    return;
  }
}

// Within the limits of all vehicles, with which a vehicle catches up [m/s].
double speed_of_check(const PlatoonModel& model) {
  double speed = kSpeed;
  for (const VehicleType& type : model.types) {
    if (type.vehicle.limits.speed) speed = std::min(speed, 0.8 * type.vehicle.limits.speed->upper);
  }
  return speed;
}

// An endless run of the same vehicles with other spacings, from rest behind a leader at constant speed.
Configuration spaced_otherwise(Configuration configuration) {
  configuration.run.launch_id += ", other spacings";
  configuration.run.steps = 0;
  configuration.run.burn_in_chosen = false;
  configuration.run.realizations = configuration.run.batch = 1;
  configuration.model.leader =
      LeaderProfile({{0, speed_of_check(configuration.model)}}, configuration.model.sample_period);
  configuration.model.recorded_leader.clear();
  configuration.model.start = Start::rest;
  for (VehicleType& type : configuration.model.types) {
    space_otherwise(type.vehicle);
    type.inherited.headway = false;
  }
  return configuration;
}

}  // namespace

VehicleCheck::VehicleCheck(ros::NodeHandle platoon, const Configuration& present, const Configuration& next,
                           std::size_t vehicle, double patience)
    : SimulatedPredecessor(platoon, present, vehicle, patience), present_(present), next_(next) {}

std::optional<BrokenClause> VehicleCheck::run(const Holds& holds) {
  const std::vector<std::pair<void (VehicleCheck::*)(), std::vector<Clause>>> parts = {
      {&VehicleCheck::check_publishers, {Clause::one_publisher}},
      {&VehicleCheck::check_batches, {Clause::answer, Clause::size, Clause::finite, Clause::stamp}},
      {&VehicleCheck::check_turn, {Clause::turn}},
      {&VehicleCheck::check_attempts, {Clause::attempt}},
      {&VehicleCheck::check_repetition, {Clause::start_anew, Clause::causal}},
      {&VehicleCheck::check_queues, {Clause::queues}},
      {&VehicleCheck::check_runs, {Clause::run}},
      {&VehicleCheck::check_spacing, {Clause::spacing}},
  };
  try {
    for (const auto& part : parts) {
      tested_.reset();
      (this->*part.first)();
      for (const Clause clause : part.second) holds(clause);
    }
  } catch (const BrokenClause& error) {
    return error;
  }
  return std::nullopt;
}

void VehicleCheck::check_publishers() {
  for (const Answers& answers : answers_) {
    const std::string topic = answers.subscriber.getTopic();
    const std::vector<std::string> names = registered_publishers(topic);
    if (names.size() > 1)
      throw BrokenClause(Clause::one_publisher, names[0] + " and " + names[1] + " publish " + topic);
  }
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
  constexpr std::int64_t kUntil = kFewestSteps - 1;
  const auto answers_with = [this](double shift) {
    begin_batch(sent_.attempt + 1, 0);
    go_on_to(kUntil - 1);
    send_next(shift);
    wait_for_answer(kUntil);
    return answers_;
  };
  const std::vector<Answers> first = answers_with(0.0), second = answers_with(1.0);
  for (std::int64_t step = kInitialStep; step <= kUntil; ++step) {
    for (std::size_t n = 0; n < first.size(); ++n) {
      const std::vector<double>&one = first[n].values.at(step), &other = second[n].values.at(step);
      if (same_bits(one, other)) continue;
      std::size_t r = 0;
      while (one[r] == other[r] && r + 1 < one.size()) ++r;
      const std::string what = here(answers_[n], step) +
                               formatted(": realization %zu at %.17g %s, after the same messages at %.17g %s before", r,
                                         other[r], first[n].unit, one[r], first[n].unit);
      if (step < kUntil) throw BrokenClause(Clause::start_anew, what);
      throw BrokenClause(Clause::causal, what + ": it depends on the message of the same step");
    }
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

// The vehicles ahead drive at constant speed. A vehicle that is slower than the model's gets more steps.
void VehicleCheck::check_spacing() {
  constexpr int kDoublings = 4;
  const Configuration spaced = spaced_otherwise(next_);
  const VehicleModel usual = vehicle(next_.model, vehicle_), other = vehicle(spaced.model, vehicle_);
  speed_ = speed_of_check(spaced.model) * spaced.model.sample_period;
  wobble_ = 0.0;
  const double spacing = other.standstill_distance + other.headway * speed_;
  const double by_headway = std::abs(other.headway - usual.headway) * speed_;
  // Half of the error of a vehicle that ignores the distance or the headway.
  const double most = 0.5 * (by_headway > 0.0 ? std::min(by_headway, kMoreDistance) : kMoreDistance);
  begin_run(spaced);
  std::int64_t step = std::clamp<std::int64_t>(settling_steps(spaced.model, 1).value_or(0), 200, 20000);
  for (int doubling = 0;; ++doubling, step *= 2) {
    go_on_to(step);
    double due = 0.0;  // a position
    for (const Input& input : other.inputs) {
      if (input.signal != InputSignal::position) continue;
      const std::size_t source = source_of(input, vehicle_);
      due += input.gain * (position_of(source, step, 0) - static_cast<double>(vehicle_ - source) * spacing);
    }
    const double predecessor = position_of(vehicle_ - 1, step, 0),
                 distance = predecessor - answers_.front().values.at(step).front();
    if (std::abs(predecessor - due - distance) <= most) return;
    if (doubling < kDoublings) continue;
    throw BrokenClause(
        Clause::spacing,
        here(answers_.front(), step) +
            formatted(": %.6g m behind a predecessor that drives %g m per step; due: %.6g m, with a standstill "
                      "distance of %g m and a headway of %g steps",
                      distance, speed_, predecessor - due, other.standstill_distance, other.headway));
  }
}

}  // namespace platoon
