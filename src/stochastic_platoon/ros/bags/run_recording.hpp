#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/ros/bags/bag_writer.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/arrivals.hpp"

namespace platoon {

/// The topics of a recording's streams: the positions of vehicles 0 .. N, the positions that followers 1 .. N received,
/// and with radios the control inputs that are sent and received.
std::vector<std::string> recorded_topics(const Configuration& configuration, const std::string& name_space);

/// Whether these are the statistics of a complete run, of its last step: the last message of a recording.
bool is_final(const stochastic_platoon::ErrorStatistics& message, const RunOptions& run);

/// Writes a platoon's messages to a bag, in the order of steps and vehicles. A step is written when it has arrived on
/// all streams, so only messages of incomplete steps are kept in memory. A finished file holds whole batches only: if
/// an attempt was abandoned, the file is written once more without it. (An endless run has no batches: its steps stay
/// as they arrived.)
///
/// The unfinished file of a killed recorder is put aside as FILE.active.1, .2, ... Only its end is read, so recovery
/// time does not depend on its size. The files are joined when the recording is finished or stopped.
class RunRecording {
public:
  /// `name_space` is the platoon's, "/platoon". Continues after the whole batches of an unfinished file of the same
  /// launch. Throws ConfigurationError, as receive() and finish() do, if a file of another launch has a name that this
  /// recording needs, and leaves that file unchanged.
  RunRecording(const Configuration& configuration, const std::string& name_space);

  DropReason receive(std::size_t stream, const stochastic_platoon::Position::ConstPtr& message);

  /// Ignores statistics before the first position, unless they are final: the topic is latched, and still has the
  /// statistics of the run that change_run ended.
  void receive(const stochastic_platoon::ErrorStatistics& message);

  /// Everything has arrived, the final statistics included.
  bool ready_to_finish() const { return !finished_ && arrivals_.complete() && final_statistics_; }

  /// Closes, syncs and renames the file. If recorded batches have become unreadable, finished() stays false and the run
  /// must repeat them.
  void finish();

  /// Closes an unfinished file.
  void stop();

  /// Closes the file after a function of this object has thrown on a write error. A new object then continues the file.
  void abandon() noexcept;

  const Arrivals& arrivals() const { return arrivals_; }
  bool finished() const { return finished_; }
  /// The file must be written once more, without abandoned attempts and with the files put aside.
  bool needs_rewriting() const { return holds_abandoned_ || !put_aside_.empty(); }
  /// Bytes written, over all files.
  std::uint64_t bytes() const { return completed_bytes_ + (recording_ ? recording_->bytes() : 0); }

private:
  using Message = stochastic_platoon::Position::ConstPtr;
  struct Step {
    std::vector<Message> messages;  ///< per stream
    std::size_t arrived = 0;
  };
  void take(std::size_t stream, const Message& message);
  std::optional<std::size_t> stream_of(const PlatoonTopic& topic) const;
  void restarted();
  void batch_complete();
  bool complete_file();
  void recover();
  bool take_over(const std::string& file);
  void require_same_launch(const std::string& file, const std::string& configuration) const;
  void rewrite();
  std::string name_of_part(std::size_t part) const;
  std::string next_put_aside() const;
  std::unique_ptr<BagWriter> record_to(const std::string& suffix) const;

  Configuration configuration_;
  std::string name_space_;
  std::vector<std::string> topics_;  ///< per stream
  std::map<PlatoonTopic::Key, std::size_t> streams_;
  RecordedConfiguration recorded_configuration_;
  std::size_t part_ = 0;
  std::map<std::pair<std::uint64_t, std::int64_t>, Step> open_;  ///< by first realization and step
  std::vector<std::string> put_aside_;                           ///< files of this part, in their order
  std::uint64_t part_begin_ = 0;                                 ///< first realization of this part
  bool partial_ = false;                                         ///< the file ends with a part of a batch
  bool holds_abandoned_ = false;                                 ///< the file holds a part of an abandoned attempt
  Arrivals arrivals_;
  bool final_statistics_ = false;
  bool finished_ = false;
  std::uint64_t completed_bytes_ = 0;
  std::unique_ptr<BagWriter> recording_;
};

}  // namespace platoon
