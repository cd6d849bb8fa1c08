#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/vehicle_contract.hpp"

namespace platoon {

/// A breach of a clause of the vehicle contract.
struct BrokenClause : std::runtime_error {
  BrokenClause(Clause of, const std::string& text) : std::runtime_error(text), clause(of) {}
  Clause clause;
};

/// The vehicles ahead of one vehicle, with leader, channel and monitor: sends it all its inputs, free of noise, and
/// judges each answer by the vehicle contract. All vehicles ahead move alike, each from its place. Throws BrokenClause.
///
/// Sets the parameter `configuration`, as a launch would. Subscribes: `vehicle_<i>/position`, and `vehicle_<i>/input`
/// if a vehicle behind hears it. Publishes: received_topic() of its inputs, `vehicle_<i>/predecessor_position` of the
/// paper's. All stochastic_platoon/Position.
class SimulatedPredecessor {
public:
  /// `patience`: time limit for an answer [s]. All runs have the inputs and the radios of `configuration`.
  SimulatedPredecessor(ros::NodeHandle platoon, const Configuration& configuration, std::size_t vehicle,
                       double patience);

  /// Waits at most `seconds` [s] for the vehicle; returns whether it is_linked() since the first call.
  bool wait_for_vehicle(double seconds);

  /// What the vehicle does not do: "publish /platoon/vehicle_3/position and subscribe to ..."; empty if nothing.
  std::string missing_links() const;

protected:
  /// The vehicle's answers on one topic.
  struct Answers {
    const char* unit;
    ros::Subscriber subscriber = {};
    std::map<std::int64_t, std::vector<double>> values = {};  ///< of the batch, by step
    bool starting = false;                                    ///< none of this batch yet: other messages are ignored
    std::set<std::string> publishers = {};

    std::int64_t latest() const { return values.empty() ? kNothingYet : values.rbegin()->first; }
  };

  void begin_run(const Configuration& configuration);
  void begin_batch(std::uint32_t attempt, std::uint64_t first_realization);
  void go_on_to(std::int64_t step);
  void send(const MessageId& id, std::uint64_t run, double shift = 0.0);
  void send_next(double shift = 0.0);
  double position_of(std::size_t source, std::int64_t step, std::uint64_t realization) const;
  void wait_for_answer(std::int64_t step);
  std::string here(const Answers& answers, std::int64_t step) const;

  std::size_t vehicle_;
  BatchSchedule schedule_{1, 1, 1};
  std::uint64_t run_ = 0;
  MessageId sent_{0, 0, kNothingYet};  ///< the latest message sent in turn
  double speed_ = 2.0, wobble_ = 0.5;  ///< of the vehicles ahead [m per step], [m], different in each realization
  std::optional<Clause> tested_;       ///< the clause that a wrong or missing answer breaks at present
  std::vector<Answers> answers_;       ///< positions, and inputs if a vehicle behind hears them

private:
  using Message = stochastic_platoon::Position;
  /// A message of answers_[first].
  using Received = std::pair<std::size_t, PositionEvent>;

  void listen(const std::string& topic, const char* unit);
  bool is_starting() const;
  std::optional<Received> next(double seconds);
  void judge(const Received& received);
  void judge_name(const Answers& answers, const Message& message) const;
  std::string place(const Answers& answers, const MessageId& id) const;
  void judge_end(const Answers& answers, const Message& message) const;
  void judge_start(const Message& message) const;
  double value_of(const Input& input, std::int64_t step, std::uint64_t realization) const;

  ros::NodeHandle platoon_;
  double patience_;             ///< [s]
  std::vector<double> places_;  ///< initial positions of the vehicles up to this one [m]
  double sample_period_ = 0.0;  ///< T_s [s]
  ros::Duration period_;
  ros::Time stamp_;  ///< of the latest message in turn
  ros::Time start_;  ///< stamp of the batch's step -1
  std::deque<Received> received_;
  std::optional<double> began_;  ///< [s] first wait for the vehicle
  /// An input of the vehicle.
  struct Sent {
    Input input;
    ros::Publisher publisher;
  };
  std::vector<Sent> sent_inputs_;
};

}  // namespace platoon
