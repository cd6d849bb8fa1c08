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

/// Keeps mean and variance of all tracking errors online, beside the paper's prediction, and acknowledges
/// what has arrived.
///
/// A batch counts when it is whole. Totals are checkpointed after commits; on completion, or when it is
/// stopped, the monitor writes the results. It names who holds the platoon up when nothing moves.
///
/// Positions may be received by several threads: a message is judged and counted under a lock, its errors are
/// formed without it (see RunStatistics). Only the timer's thread touches files and the terminal, and never
/// under the lock.
///
/// Subscribes: vehicle_<i>/position (stochastic_platoon/Position), i = 0 .. N; progress (stochastic_platoon/Progress,
/// of others). Publishes: progress, snapshot (stochastic_platoon/Snapshot), and what StatisticsPublisher does. Service:
/// change_run (see RunChange).
class Monitor {
public:
  /// Gives the node whose queue receives the positions of a vehicle: several threads may serve these queues.
  using NodeOfVehicle = std::function<ros::NodeHandle(std::size_t vehicle)>;

  /// Throws ConfigurationError as starting_point() does. `superseded` is called with a configuration that has
  /// taken the present one's place.
  Monitor(ros::NodeHandle platoon, const Configuration& configuration, const NodeOfVehicle& node_of_vehicle,
          RunMembership::Join superseded);

  /// A status of what has arrived, and of who holds the platoon up: "culprit", empty while nothing does, and the
  /// "retries" since it stands still.
  Diagnostics::Fill status();

  /// Writes down what there is of an unfinished run. Call it when the callbacks have ended.
  void stop();

private:
  void subscribe(ros::NodeHandle platoon, const NodeOfVehicle& node_of_vehicle);
  void receive(std::size_t vehicle, const PositionEvent& event);
  void receive_notice(const stochastic_platoon::Progress::ConstPtr& message);
  void tick();
  void check_for_stall(double present);
  std::vector<std::size_t> missing_vehicles() const;
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

  SpinLock lock_;  ///< of what several threads use, down to `began_`
  RunStatistics statistics_;
  std::vector<PositionInput> inputs_;  ///< each for the one thread that receives from the vehicle
  ProgressReports reports_;
  StallReporter stall_;
  std::optional<double> began_;  ///< [s] first complete step of this launch

  ProgressDisplay display_;
  bool finished_ = false;
  bool departs_ = false;  ///< the leader, as last said

  StatisticsPublisher publisher_;
  std::vector<ros::Subscriber> positions_;
  ros::Subscriber others_;
  Snapshots snapshots_;
  RunChange change_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
