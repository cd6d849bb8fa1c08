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

/// What the index of a bag has to be, from the messages in front of it: behind each chunk the times and places of its
/// messages, at the end of the file a summary of every chunk. A reader of records needs no index, but what
/// contradicts it is damaged. Throws BagDamage.
class BagIndex {
public:
  void begin_chunk(std::uint64_t position);
  /// `time` as in the record: seconds, nanoseconds. `offset` of the message within its chunk.
  void add(std::uint32_t connection, std::uint64_t time, std::uint32_t offset);
  void end_chunk();

  /// The index of one connection in the latest chunk.
  void verify(const Fields& header, std::string_view entries);
  /// The latest chunk has all of its index.
  void require_complete() const;

  /// The summary of the next chunk.
  void verify_summary(const Fields& header, std::string_view counts);
  /// Chunks whose summary has not come.
  std::size_t without_summary() const { return summaries_.size() - verified_; }
  std::size_t chunks() const { return summaries_.size(); }

private:
  struct Chunk {
    std::uint64_t position = 0, first_time = 0, last_time = 0;
    std::map<std::uint32_t, std::uint32_t> counts;  ///< messages by connection
  };
  static std::uint64_t digest_of(const Chunk& chunk);

  Chunk chunk_;
  std::map<std::uint32_t, std::string> entries_;  ///< by connection, as a bag writes them
  std::size_t unverified_ = 0;                    ///< connections of the chunk
  std::vector<std::uint64_t> summaries_;          ///< digests
  std::size_t verified_ = 0;
};

}  // namespace platoon
