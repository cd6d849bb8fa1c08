#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>
#include <stochastic_platoon/Progress.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/observation/diagnostics.hpp"
#include "stochastic_platoon/ros/observation/snapshots.hpp"
#include "stochastic_platoon/ros/observation/stall_reporter.hpp"
#include "stochastic_platoon/ros/observation/statistics_publisher.hpp"
#include "stochastic_platoon/ros/orders/run_change.hpp"
#include "stochastic_platoon/ros/transport/position_input.hpp"
#include "stochastic_platoon/ros/transport/progress_reports.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/spin_lock.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/io/progress_display.hpp"
#include "stochastic_platoon/run/results/run_statistics.hpp"
#include "stochastic_platoon/run/results/run_store.hpp"

namespace platoon {

/// Computes mean and variance of all tracking errors online, publishes them beside the paper's prediction, and
/// acknowledges messages.
///
/// A batch counts when it is complete. Totals are checkpointed after commits; on completion, or when it is stopped, the
/// monitor writes the results. If the run stalls, it names the node that blocks it.
///
/// Several threads may receive positions: a message is checked and counted under a lock, its errors are computed
/// without it (see RunStatistics). Files and the terminal are accessed by the timer's thread and, after the callbacks
/// have ended, by stop(); never under the lock.
///
/// Subscribes: `vehicle_<i>/position` (stochastic_platoon/Position), i = 0 .. N; progress (stochastic_platoon/Progress,
/// of other components). Publishes: progress, snapshot (stochastic_platoon/Snapshot), and the topics of
/// StatisticsPublisher. Service: change_run (see RunChange). Sets the parameters of set_run_parameters().
class Monitor {
public:
  /// Returns the node handle whose queue receives the positions of a vehicle. Several threads may serve these queues.
  using NodeOfVehicle = std::function<ros::NodeHandle(std::size_t vehicle)>;

  /// Throws ConfigurationError as starting_point() does. `superseded` is called with the configuration that replaces
  /// the present one.
  Monitor(ros::NodeHandle platoon, const Configuration& configuration, const NodeOfVehicle& node_of_vehicle,
          RunMembership::Join superseded);

  /// Status: messages received, "culprit" (the reason of a stall, empty without one), and "retries" since the stall
  /// began.
  Diagnostics::Fill status();

  /// Saves an unfinished run and prints its report. Call it after the callbacks have ended. Throws std::runtime_error
  /// after the report if the run cannot be saved.
  void stop();

private:
  void subscribe(ros::NodeHandle platoon, const NodeOfVehicle& node_of_vehicle);
  void receive(std::size_t vehicle, const PositionEvent& event);
  /// Takes no lock: RunStatistics::compute() reads nothing that changes.
  std::vector<ReducedSignals> compute(const std::vector<DueSignals>& due) const
      PLATOON_THREAD_SAFETY(no_thread_safety_analysis) {
    return statistics_.compute(due);
  }
  void receive_notice(const stochastic_platoon::Progress::ConstPtr& message);
  void tick();
  void check_for_stall(double present);
  std::vector<std::size_t> missing_vehicles() const;
  const std::vector<std::size_t>& mute_vehicles(double present);
  void show_start(double present);
  void show_manoeuvre(bool departs);
  void finish();
  void save_checkpoint_if_due(double present);
  void publish_statistics_if_due(double present);
  bool endless() const { return configuration_.run.averaging() == Averaging::over_time; }

  Configuration configuration_;
  RunStore store_;
  RunMembership membership_;
  Prediction prediction_;
  double wall_seconds_before_;  ///< [s] of earlier launches

  SpinLock lock_;
  RunStatistics statistics_ PLATOON_GUARDED_BY(lock_);
  ProgressReports reports_ PLATOON_GUARDED_BY(lock_);
  StallReporter stall_ PLATOON_GUARDED_BY(lock_);
  std::optional<double> began_ PLATOON_GUARDED_BY(lock_);  ///< [s] first complete step of this launch

  ProgressDisplay display_;
  bool finished_ = false;
  std::vector<std::size_t> mute_;  ///< vehicles without an input that their follower receives
  double ask_again_ = 0.0;         ///< [s] the monitor asks the master for mute vehicles no earlier than this
  bool departs_ = false;           ///< whether the leader manoeuvres, as last logged

  StatisticsPublisher publisher_;
  std::vector<PositionInput> inputs_;  ///< per vehicle, used by the thread that receives from it
  ros::Subscriber others_;
  Snapshots snapshots_;
  RunChange change_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
