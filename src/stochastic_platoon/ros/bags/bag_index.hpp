#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "stochastic_platoon/ros/bags/bag_records.hpp"

namespace platoon {

constexpr std::size_t kIndexEntry = 8 + 4;    ///< bytes: time, offset
constexpr std::size_t kSummaryEntry = 4 + 4;  ///< bytes: connection, messages

/// Verifies the index of a bag against its messages: after each chunk the times and offsets of its messages, at the end
/// of the file a summary of every chunk. Reading records needs no index, but a contradiction means that the file is
/// damaged. Throws BagDamage.
class BagIndex {
public:
  void begin_chunk(std::uint64_t position);
  /// `time`: as in the record (seconds, nanoseconds). `offset`: of the message within its chunk [bytes].
  void add(std::uint32_t connection, std::uint64_t time, std::uint32_t offset);
  void end_chunk();

  /// Verifies the index of one connection in the latest chunk.
  void verify(const Fields& header, std::string_view entries);
  /// Throws BagDamage if a part of the latest chunk's index is missing.
  void require_complete() const;

  /// Verifies the summary of the next chunk.
  void verify_summary(const Fields& header, std::string_view counts);
  /// Number of chunks whose summary has not been read.
  std::size_t without_summary() const { return summaries_.size() - verified_; }
  std::size_t chunks() const { return summaries_.size(); }

private:
  struct Chunk {
    std::uint64_t position = 0, first_time = 0, last_time = 0;
    std::map<std::uint32_t, std::uint32_t> counts;  ///< messages by connection
  };
  static std::uint64_t digest_of(const Chunk& chunk);

  Chunk chunk_;
  std::map<std::uint32_t, std::string> entries_;  ///< by connection, in the bag's format
  std::size_t unverified_ = 0;                    ///< connections of the chunk whose index has not been read
  std::vector<std::uint64_t> summaries_;          ///< digest of each chunk's expected summary
  std::size_t verified_ = 0;
};

}  // namespace platoon
