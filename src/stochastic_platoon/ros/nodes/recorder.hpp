#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>
#include <stochastic_platoon/Progress.h>

#include <optional>
#include <vector>

#include "stochastic_platoon/ros/bags/run_recording.hpp"
#include "stochastic_platoon/ros/observation/diagnostics.hpp"
#include "stochastic_platoon/ros/transport/position_input.hpp"
#include "stochastic_platoon/ros/transport/progress_reports.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/io/retry_pause.hpp"

namespace platoon {

/// Records a platoon to a bag as one more acknowledging receiver: the leader never runs ahead of it, so
/// nothing is lost at any speed.
///
/// What the disk refuses makes it pause, and the platoon with it. It says so once, tries again after a pause that
/// grows, and goes on with the whole batches of the file as a recorder does that was killed.
///
/// Subscribes: vehicle_<i>/position, vehicle_<i>/predecessor_position (stochastic_platoon/Position),
/// error_statistics (stochastic_platoon/ErrorStatistics), progress (of others). Publishes: progress
/// (stochastic_platoon/Progress).
class Recorder {
public:
  /// Throws ConfigurationError as RunRecording does. `superseded` is called with a configuration that has
  /// taken the present one's place.
  Recorder(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded);

  /// What it has recorded and dropped, of each topic of positions.
  VitalSigns::Sources sources() const;

  /// Closes an unfinished file. Call it when the callbacks have ended.
  void stop();

private:
  void begin();
  void receive(std::size_t stream, const PositionEvent& event);
  void receive_statistics(const stochastic_platoon::ErrorStatistics::ConstPtr& message);
  void tick();
  void finish();
  void report();
  template <typename Work>
  void write(const Work& work);

  Configuration configuration_;
  RunMembership membership_;
  std::string name_space_;
  std::optional<RunRecording> recording_;  ///< none while the disk refuses it
  Arrivals reported_;                      ///< what it was when it was last there
  RetryPause pause_;
  std::uint64_t tried_at_ = 0;  ///< bytes in the file when it was last begun
  std::string refusal_;         ///< by the disk, of the latest try
  std::vector<PositionInput> inputs_;
  std::optional<double> began_;  ///< [s] first message
  ProgressReports reports_;
  std::vector<ros::Subscriber> positions_;
  ros::Subscriber error_statistics_;
  ros::Subscriber progress_;
  std::vector<ros::Subscriber> links_;  ///< all of these: the run begins when the recorder hears everyone
  ros::SteadyTimer timer_;
};

}  // namespace platoon
