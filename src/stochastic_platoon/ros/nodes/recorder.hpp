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
#include "stochastic_platoon/run/io/retried_write.hpp"

namespace platoon {

/// Records a platoon to a bag as one more acknowledging receiver: the leader never runs ahead of it, so
/// nothing is lost at any speed.
///
/// The first report waits for the publishers of all topics, but not for ever for an input: a vehicle may advertise it
/// as late as with the run's first message, and the leader then repeats what was lost.
///
/// Write errors pause the recording, and the platoon with it. The recorder logs this once, retries after growing
/// pauses, and continues after the whole batches of the file, as a restarted recorder does.
///
/// Subscribes: `vehicle_<i>/position`, `vehicle_<i>/predecessor_position`, and with radios `vehicle_<i>/input` and
/// `vehicle_<i>/predecessor_input` (stochastic_platoon/Position), error_statistics
/// (stochastic_platoon/ErrorStatistics), progress (of other components). Publishes: progress
/// (stochastic_platoon/Progress).
class Recorder {
public:
  /// Throws ConfigurationError as RunRecording does. `superseded` is called with the configuration that replaces the
  /// present one.
  Recorder(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded);

  /// Messages recorded and dropped, per topic of positions.
  VitalSigns::Sources sources() const;

  /// Closes an unfinished file. Call it after the callbacks have ended.
  void stop();

private:
  void begin();
  void receive(std::size_t stream, const PositionEvent& event);
  void receive_statistics(const stochastic_platoon::ErrorStatistics::ConstPtr& message);
  void tick();
  std::optional<std::string> awaited_topic();
  void finish();
  void report();
  template <typename Work>
  void write(const Work& work);

  Configuration configuration_;
  RunMembership membership_;
  std::string name_space_;
  std::vector<std::string> topics_;        ///< per stream
  std::optional<RunRecording> recording_;  ///< none after a write error
  Arrivals reported_;                      ///< arrivals of the latest recording
  RetryPause pause_;
  std::uint64_t tried_at_ = 0;                                      ///< bytes in the file when it was last opened
  std::string write_error_;                                         ///< the latest write error
  stochastic_platoon::ErrorStatistics::ConstPtr final_statistics_;  ///< received while nothing could be written, too
  std::optional<double> began_;                                     ///< [s] first message
  std::optional<double> heard_;  ///< [s] since when all topics but inputs have a publisher
  ProgressReports reports_;
  std::vector<PositionInput> inputs_;  ///< per stream
  ros::Subscriber error_statistics_;
  ros::Subscriber progress_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
