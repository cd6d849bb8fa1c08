#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <functional>
#include <vector>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/graph/progress_reports.hpp"
#include "stochastic_platoon/graph/refusals.hpp"
#include "stochastic_platoon/graph/spin_lock.hpp"
#include "stochastic_platoon/results/progress_display.hpp"
#include "stochastic_platoon/results/run_statistics.hpp"

namespace platoon {

/// Keeps mean and variance of all tracking errors online, beside the paper's prediction, and acknowledges
/// what has arrived.
///
/// A batch counts when it is whole. Totals are checkpointed after commits; on completion, or when it is
/// stopped, the monitor writes the results. It names who holds the platoon up when nothing moves.
///
/// Subscribes: vehicle_<i>/position, i = 0 .. N; progress (of other receivers). Publishes: progress,
/// error_statistics, configuration (std_msgs/String, latched: the model and the run as JSON).
class Monitor {
public:
  /// Throws ConfigurationError as starting_point() does. `of_vehicle` gives the node whose queue receives the
  /// positions of vehicle i: several threads may serve these queues.
  Monitor(ros::NodeHandle platoon, const Configuration& configuration,
          const std::function<ros::NodeHandle(std::size_t vehicle)>& of_vehicle);
  Monitor(const ros::NodeHandle& platoon, const Configuration& configuration)
      : Monitor(platoon, configuration, [&platoon](std::size_t) { return platoon; }) {}

  /// Writes down what there is of an unfinished run. Call it when the callbacks have ended.
  void stop();

private:
  void receive(std::size_t vehicle, const stochastic_platoon::Position::ConstPtr& message);
  void note_commit();
  void tick();
  void report_stall(double now);
  void finish();
  void save_checkpoint();
  void publish_statistics(std::int64_t step, const std::vector<Moments>& all);

  SpinLock lock_;  ///< of everything below, but for the arithmetic of the statistics
  Configuration configuration_;
  Prediction prediction_;
  RunStatistics statistics_;
  std::vector<Refusals> refusals_;
  ProgressDisplay display_;
  double began_ = -1.0;               ///< [s] first complete step of this launch
  double wall_seconds_before_ = 0.0;  ///< [s] of earlier launches
  double last_arrival_ = -1.0;        ///< [s]
  double last_checkpoint_ = -1.0;     ///< [s]
  double last_statistics_ = -1.0;     ///< [s]
  std::uint64_t committed_ = 0;       ///< realizations when last looked at
  std::uint64_t checkpointed_ = 0;    ///< realizations in the latest checkpoint
  bool stalled_ = false;
  bool finished_ = false;
  ProgressReports reports_;
  ros::Publisher error_statistics_;
  ros::Publisher configuration_text_;  ///< latched: whoever records the platoon records what it was
  std::vector<ros::Subscriber> positions_;
  ros::Subscriber notes_;  ///< of the other receivers
  ros::SteadyTimer timer_;
};

}  // namespace platoon
