#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/vehicle_contract.hpp"

namespace platoon {

/// Tests one vehicle against the vehicle contract, in place of leader, channel and monitor: batches of 1000 and of 1,
/// messages out of turn, newer and older attempts, the same batch again, a whole batch at once, another run.
///
/// Sets the parameter `configuration`, as a launch would. Subscribes: vehicle_<i>/position. Publishes:
/// vehicle_<i>/predecessor_position. Both stochastic_platoon/Position.
class VehicleCheck {
public:
  struct Breach {
    Clause clause;
    std::string what;  ///< "step 3 of the realizations from 0: 999 positions, of 1000"
  };
  /// Called with each clause as soon as it is known to hold.
  using Holds = std::function<void(Clause)>;

  /// `present` and `next` are two runs of 1001 realizations in batches of 1000. `patience`: time limit for an answer
  /// [s].
  VehicleCheck(ros::NodeHandle platoon, const Configuration& present, const Configuration& next, std::size_t vehicle,
               double patience);

  /// Waits at most `seconds` [s] for the vehicle; returns whether it is connected.
  bool wait_for_vehicle(double seconds);

  /// The first breach of the contract, or none. Serves the global callback queue while it runs.
  std::optional<Breach> run(const Holds& holds);

private:
  using Message = stochastic_platoon::Position;
  struct Received {
    Message::ConstPtr message;
    std::string publisher;
  };
  void check_publishers();
  void check_batches();
  void check_turn();
  void check_attempts();
  void check_repetition();
  void check_queues();
  void check_runs();

  void begin_run(const Configuration& configuration);
  void begin_batch(std::uint32_t attempt, std::uint64_t first_realization);
  void go_on_to(std::int64_t step);
  void send(const MessageId& id, std::uint64_t run, double shift = 0.0);
  void send_next(double shift = 0.0);
  void wait_for_answer(std::int64_t step);
  std::optional<Received> next(double seconds);
  void judge(const Received& received);
  void judge_name(const Message& message) const;
  [[noreturn]] void broken(Clause clause, const std::string& what) const;
  std::string here(std::int64_t step) const;

  ros::NodeHandle platoon_;
  Configuration present_, next_;
  std::string name_;
  std::size_t vehicle_;
  double patience_;  ///< [s]
  BatchSchedule schedule_;
  ros::Duration period_;

  std::uint64_t run_ = 0;
  MessageId sent_{0, 0, kNothingYet};    ///< the latest message sent in turn
  std::int64_t answered_ = kNothingYet;  ///< the latest answered step of the batch
  bool starting_ = false;                ///< no answer of this batch yet: other answers are ignored
  std::optional<Clause> tested_;         ///< the clause that a wrong or missing answer breaks at present
  ros::Time stamp_;                      ///< of the latest message in turn
  ros::Time start_;                      ///< stamp of the batch's step -1
  std::map<std::int64_t, std::vector<double>> answers_;  ///< of the batch, by step
  std::set<std::string> publishers_;
  std::deque<Received> received_;
  ros::Publisher predecessor_position_;
  ros::Subscriber position_;
};

}  // namespace platoon
