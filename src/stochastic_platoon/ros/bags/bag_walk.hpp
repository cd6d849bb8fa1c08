#pragma once

#include <rosbag/chunked_file.h>
#include <rosbag/stream.h>

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "stochastic_platoon/ros/bags/bag_index.hpp"
#include "stochastic_platoon/ros/bags/bag_records.hpp"

namespace platoon {

/// A topic in a bag.
struct BagConnection {
  std::string topic;
  std::string fields;  ///< as recorded: type, md5sum, ...
  std::string type, md5sum;
};

/// A message as a bag holds it; valid until the next one is read.
struct RawMessage {
  std::uint32_t connection;
  std::uint64_t time;  ///< [ns]
  std::string_view bytes;
  bool passed_over;  ///< in a chunk before those of skip_to_last_chunks()
  bool after_gap;    ///< the preceding chunks were not read
};

/// The messages of one bag in their order, read record by record in one pass that needs no index and only the memory of
/// one chunk. It checks lengths, connections, index, summaries and counts, which rosbag does not. Throws BagCut if the
/// file ends early or was not closed, BagDamage if it contradicts itself.
class BagWalk {
public:
  explicit BagWalk(const std::string& file);

  /// The next message; none at the end of a whole file.
  std::optional<RawMessage> next();

  const BagConnection& connection(const RawMessage& message) const { return connections_.at(message.connection); }

  /// Skips to the last `count` whole chunks and the records after them; call it before next(). Earlier chunks are read
  /// only if they introduce a connection. Returns the number of earlier chunks.
  std::size_t skip_to_last_chunks(std::size_t count);

  std::uint64_t position() const { return file_.position(); }
  std::uint64_t size() const { return file_.size(); }

private:
  void take_file_header();
  void take_record();
  void take_chunk(const Fields& header);
  std::string_view unpacked(std::string_view data, const std::string& compression, std::size_t size);
  std::optional<RawMessage> take_from_chunk();
  void take_connection(const Fields& header, std::string_view data);
  void take_summaries(const Fields& header, std::string_view data);
  void require_whole() const;

  BagBytes file_;
  std::uint64_t index_position_ = 0;  ///< 0: the file was not closed
  std::uint32_t connection_count_ = 0, chunk_count_ = 0;
  std::map<std::uint32_t, BagConnection> connections_;
  std::set<std::uint32_t> summarized_;  ///< connections at the end of the file
  BagIndex index_;

  std::string header_bytes_, data_bytes_, plain_bytes_;  ///< of the present record
  std::string_view chunk_, rest_;                        ///< the present chunk, and its unread rest
  bool in_chunk_ = false;
  bool chunk_is_cut_ = false;  ///< the file ends within it

  std::deque<std::uint64_t> visits_;  ///< positions: chunks that introduce connections, then the first to read
  bool passing_over_ = false;
  bool skipped_ = false;
  bool gap_ = false;

  rosbag::ChunkedFile no_file_;
  rosbag::StreamFactory streams_;
};

}  // namespace platoon
