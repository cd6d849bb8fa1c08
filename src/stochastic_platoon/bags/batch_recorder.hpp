#pragma once

#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "stochastic_platoon/bags/recording.hpp"
#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/delivery/arrivals.hpp"

namespace platoon {

/// Writes a platoon's messages to a bag, batch by batch: what is in the file is whole batches in the order of
/// steps and vehicles, never a part of an attempt that was given up. (An endless run has no batches: its
/// messages are written as they come.)
///
/// Its streams are the positions of vehicles 0 .. N as 0 .. N, and what followers 1 .. N received as N + 1 ..
/// 2 N.
class BatchRecorder {
public:
  /// `name_space` is the platoon's, "/platoon". Goes on with the unfinished file of the same launch, from
  /// which the whole batches are taken over; nothing else is touched: throws ConfigurationError when such a
  /// file is of another launch.
  BatchRecorder(const Configuration& configuration, const std::string& name_space);

  Verdict receive(std::size_t stream, const stochastic_platoon::Position::ConstPtr& message);
  void receive(const stochastic_platoon::ErrorStatistics& message);

  /// Closes, syncs and names the file once everything has arrived, the final statistics included; true when
  /// that is done.
  bool finish();

  /// Closes an unfinished file.
  void stop();

  const Arrivals& arrivals() const { return arrivals_; }
  bool finished() const { return finished_; }
  /// Bytes written so far, at most one batch ago.
  std::uint64_t bytes() const { return bytes_; }

  /// Topic of a stream.
  std::string topic(std::size_t stream) const;

private:
  using Message = stochastic_platoon::Position::ConstPtr;
  struct Kept {
    std::size_t stream;
    Message message;
  };
  void take(std::size_t stream, const Message& message);
  void write_batch(std::uint64_t first_realization);
  /// Throws what the writing threw.
  void wait_for_writing();
  void recover();
  void take_over(const std::string& file);
  std::uint64_t end_of_part(std::size_t part) const;
  std::unique_ptr<Recording> record_to(const std::string& suffix) const;

  Configuration configuration_;
  std::string name_space_;
  RecordingOptions options_;
  std::string configuration_text_;
  std::size_t part_ = 0;
  std::map<std::uint64_t, std::vector<Kept>> open_;  ///< messages of open batches, by their first realization
  Arrivals arrivals_;
  bool final_statistics_ = false;
  bool finished_ = false;
  std::uint64_t bytes_ = 0;
  std::unique_ptr<Recording> recording_;
  std::future<void>
      writing_;  ///< of the batch that is being written; its end is waited for by the destructor, too
};

}  // namespace platoon
