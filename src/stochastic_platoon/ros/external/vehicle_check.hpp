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

/// Drives one vehicle alone through the vehicle contract, in the place of leader, channel and monitor: batches of
/// 1000 and of 1, messages out of turn, newer and older attempts, the same batch again, a whole batch at once,
/// another run.
///
/// Sets the parameter `configuration`, as a launch would. Subscribes: vehicle_<i>/position. Publishes:
/// vehicle_<i>/predecessor_position. Both stochastic_platoon/Position.
class VehicleCheck {
public:
  struct Breach {
    Clause clause;
    std::string what;  ///< "step 3 of the realizations from 0: 999 positions, of 1000"
  };
  /// Called with what is known to hold, as soon as it is.
  using Holds = std::function<void(Clause)>;

  /// `present` and `next` are two runs of one vehicle more than 1000 realizations in batches of 1000. `patience` [s]
  /// for an answer.
  VehicleCheck(ros::NodeHandle platoon, const Configuration& present, const Configuration& next, std::size_t vehicle,
               double patience);

  /// Whether the vehicle is there; waits for at most so long [s].
  bool wait_for_vehicle(double seconds);

  /// The first breach of the contract, or none. Serves the global callback queue meanwhile.
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
  MessageId sent_{0, 0, kNothingYet};    ///< the latest that was in turn
  std::int64_t answered_ = kNothingYet;  ///< the latest step of the batch
  bool starting_ = false;                ///< nothing of the batch has come: what comes is of the one before
  std::optional<Clause> tested_;         ///< what a wrong or missing answer breaks just now
  ros::Time stamp_;                      ///< of what was sent last
  ros::Time start_;                      ///< stamp of the batch's step -1
  std::map<std::int64_t, std::vector<double>> answers_;  ///< of the batch
  std::set<std::string> publishers_;
  std::deque<Received> received_;
  ros::Publisher predecessor_position_;
  ros::Subscriber position_;
};

}  // namespace platoon
