#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <vector>

#include "stochastic_platoon/bags/batch_recorder.hpp"
#include "stochastic_platoon/graph/progress_reports.hpp"
#include "stochastic_platoon/graph/refusals.hpp"

namespace platoon {

/// Records a platoon to a bag as one more acknowledging receiver: the leader never runs ahead of it, so
/// nothing is lost at any speed.
///
/// Subscribes: vehicle_<i>/position, vehicle_<i>/predecessor_position, error_statistics. Publishes: progress.
class Recorder {
public:
  /// Throws ConfigurationError as BatchRecorder does.
  Recorder(ros::NodeHandle platoon, const Configuration& configuration);

  /// Closes an unfinished file. Call it when the callbacks have ended.
  void stop() { recorder_.stop(); }

private:
  void receive(std::size_t stream, const stochastic_platoon::Position::ConstPtr& message);
  void receive_statistics(const stochastic_platoon::ErrorStatistics::ConstPtr& message);
  void tick();
  void finish();
  void report();

  BatchRecorder recorder_;
  std::vector<Refusals> refusals_;
  double began_ = -1.0;  ///< [s] first message
  ProgressReports reports_;
  std::vector<ros::Subscriber> positions_;
  ros::Subscriber error_statistics_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
