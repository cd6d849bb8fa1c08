#pragma once

#include <ros/node_handle.h>
#include <std_srvs/SetBool.h>
#include <stochastic_platoon/Position.h>
#include <stochastic_platoon/Progress.h>

#include <map>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/bags/bag_stream.hpp"
#include "stochastic_platoon/ros/bags/run_reading.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

struct PlayerOptions {
  BagSource bags;
  double rate = 0.0;    ///< platoon time per wall time; 0: as fast as the monitor takes it
  double start = 0.0;   ///< [s] of platoon time that are played as fast as possible
  bool paused = false;  ///< wait for pause_playback to be called with false
};

/// Plays the positions of all vehicles of a recorded platoon, in place of the vehicles, as messages of the present run.
/// It runs no further ahead of the monitor's progress than the leader would, so nothing is lost at any rate. The last
/// message is held back until the whole recording is verified: a replay of a damaged bag never completes, and ends with
/// a BagError.
///
/// If the monitor has lost messages, as one that was killed, the replay begins again with the first batch that is not
/// complete, under a newer attempt. It ends with a BagError if ten repetitions complete no batch. An endless recording
/// is not repeated, as the averages already hold its steps: the replay ends with a BagError.
///
/// Subscribes: progress (stochastic_platoon/Progress). Publishes: `vehicle_<i>/position` (stochastic_platoon/Position).
/// Service: ~pause_playback (std_srvs/SetBool), as in rosbag play.
class Player {
public:
  /// Throws BagError as recorded_platoon() does, and for a recording that does not begin with realization 0.
  Player(ros::NodeHandle platoon, ros::NodeHandle private_node, const Configuration& configuration,
         const PlayerOptions& options);

private:
  void receive(const stochastic_platoon::Progress::ConstPtr& message);
  void play();
  std::optional<RecordedMessage> next();
  void require_as_recorded() const;
  bool is_lost() const;
  void begin_again();
  double since_first(const stochastic_platoon::Position& message) const;
  bool may_publish(const stochastic_platoon::Position& message);
  bool is_within_window(const stochastic_platoon::Position& message) const;

  std::uint64_t run_;
  BatchSchedule schedule_;
  std::int64_t window_;
  PlayerOptions options_;
  std::optional<BagStream> stream_;
  std::optional<RunReading> reading_;        ///< of all messages read, published or not
  std::optional<RecordedMessage> upcoming_;  ///< a position
  std::map<std::pair<PlatoonTopic::Kind, std::size_t>, ros::Publisher> played_;  ///< by kind and vehicle
  bool heard_ = false;                                                           ///< the monitor has reported
  std::int64_t acknowledged_ = 0;                                                ///< steps
  std::int64_t granted_ = 0;            ///< steps that may be exceeded by a window without progress
  std::uint32_t reported_attempt_ = 0;  ///< of the monitor's latest report
  std::uint64_t committed_ = 0;         ///< realizations that the monitor has completed
  double last_progress_ = 0.0;          ///< [s]
  double last_published_ = 0.0;         ///< [s]
  bool is_behind_ = false;              ///< the monitor has reported that it has lost messages
  std::uint64_t resumes_at_ = 0;        ///< realizations before are not published again
  std::uint32_t attempts_ahead_ = 0;    ///< attempt of this replay minus the recorded one
  std::uint32_t last_attempt_ = 0;      ///< latest attempt published
  unsigned repetitions_ = 0;            ///< since the monitor has completed a batch
  ros::Time first_stamp_;
  std::optional<double> began_;      ///< [s] wall time of first_stamp_; moves on while paused
  std::optional<double> paused_at_;  ///< [s]
  ros::Subscriber progress_;
  ros::ServiceServer pause_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
