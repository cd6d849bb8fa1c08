#include "stochastic_platoon/ros/bags/bag_walk.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/ros/messages/serialized.hpp"

namespace platoon {

namespace {

struct Chunk {
  std::uint64_t begin;
  bool introduces = false;  ///< a connection that no earlier chunk has
};

// The chunks from the present position up to the first incomplete one, found by record lengths and the index after each
// chunk.
std::vector<Chunk> whole_chunks(BagBytes& file) {
  std::vector<Chunk> chunks;
  std::set<std::uint32_t> known;
  std::string bytes;
  try {
    while (file.left() > 0) {
      const std::uint64_t begin = file.position();
      const Fields header = file.take_header(bytes);
      const std::uint64_t length = file.take_length();
      if (length > file.left()) break;
      const RecordKind kind = header.kind();
      if (kind == RecordKind::chunk && length == 0) break;  // its length is written when it is complete
      if (kind == RecordKind::chunk) chunks.push_back({begin});
      if (kind == RecordKind::index && !chunks.empty() && known.insert(header.number<std::uint32_t>("conn")).second)
        chunks.back().introduces = true;
      file.pass(length);
    }
  } catch (const BagCut&) {
  } catch (const BagDamage&) {
  }
  return chunks;
}

// Length of the data after the header of an index or summary; `otherwise` for other records.
std::uint64_t announced_length(const Fields& header, std::uint32_t otherwise) {
  const bool is_index = header.kind() == RecordKind::index;
  if (!is_index && header.kind() != RecordKind::chunk_info) return otherwise;
  return std::uint64_t{is_index ? kIndexEntry : kSummaryEntry} * header.number<std::uint32_t>("count");
}

std::uint64_t nanoseconds(std::uint64_t time) {
  return (time & 0xffffffff) * 1000000000 + (time >> 32);
}

}  // namespace

BagWalk::BagWalk(const std::string& file) : file_(file), streams_(&no_file_) {
  take_file_header();
}

void BagWalk::take_file_header() {
  const Fields header = file_.take_header(header_bytes_);
  const std::uint32_t padding = file_.take_length();
  if (padding > kLongestHeader) throw BagDamage("the header of the file is malformed");
  const std::string_view data = file_.take(padding, data_bytes_);
  if (header.kind() != RecordKind::file_header ||
      !header.has_only({"op", "index_pos", "conn_count", "chunk_count", "encryptor"}) ||
      !header.text("encryptor").empty() || data.find_first_not_of(' ') != std::string_view::npos) {
    throw BagDamage("the header of the file is malformed");
  }
  index_position_ = header.number<std::uint64_t>("index_pos");
  connection_count_ = header.number<std::uint32_t>("conn_count");
  chunk_count_ = header.number<std::uint32_t>("chunk_count");
}

std::size_t BagWalk::skip_to_last_chunks(std::size_t count) {
  const std::uint64_t begin = file_.position();
  const std::vector<Chunk> chunks = whole_chunks(file_);
  const std::size_t before = chunks.size() > count ? chunks.size() - count : 0;
  for (std::size_t c = 0; c < before; ++c) {
    if (chunks[c].introduces) visits_.push_back(chunks[c].begin);
  }
  visits_.push_back(before > 0 ? chunks[before].begin : begin);
  skipped_ = before > 0;
  file_.seek(begin);
  return before;
}

std::optional<RawMessage> BagWalk::next() {
  while (true) {
    check_interruption();
    if (in_chunk_) {
      if (const std::optional<RawMessage> message = take_from_chunk()) return message;
      continue;
    }
    if (!visits_.empty()) {
      gap_ = visits_.front() != file_.position();
      file_.seek(visits_.front());
      visits_.pop_front();
      passing_over_ = !visits_.empty();
      index_ = BagIndex();
    }
    if (file_.left() == 0) break;
    if (file_.position() == index_position_) index_.require_complete();
    take_record();
    if (skipped_ && !summarized_.empty()) return std::nullopt;  // earlier chunks were not read
  }
  if (!skipped_) require_whole();
  return std::nullopt;
}

void BagWalk::take_record() {
  const std::uint64_t begin = file_.position();
  const Fields header = file_.take_header(header_bytes_);
  const RecordKind kind = header.kind();
  if (kind == RecordKind::chunk) {
    index_.begin_chunk(begin);
    return take_chunk(header);
  }
  const std::uint32_t length = file_.take_length();
  if (length > kLongestChunk) throw BagDamage("a record is longer than any");
  // If the end of the file cuts the record off, its length must still be the one that its header announces.
  if (length > file_.left() && length != announced_length(header, length))
    throw BagDamage("the length of a record is not that of its content");
  const std::string_view data = file_.take(length, data_bytes_);
  const bool in_summaries = index_position_ != 0 ? begin >= index_position_ : kind != RecordKind::index;
  if (in_summaries == (kind == RecordKind::index)) throw BagDamage("a record is not where it may be");
  if (!in_summaries) return index_.verify(header, data);
  take_summaries(header, data);
}

void BagWalk::take_chunk(const Fields& header) {
  const std::string compression(header.text("compression"));
  const auto size = header.number<std::uint32_t>("size");
  std::uint64_t length = file_.take_length();
  // The length of a chunk is written when the chunk is complete.
  const bool open = length == 0 && index_position_ == 0;
  if (open) length = file_.left();
  if (length > kLongestChunk || size > kLongestChunk || length == 0) throw BagDamage("a chunk has no possible length");
  chunk_is_cut_ = open || length > file_.left();
  if (index_position_ != 0 && file_.position() + length > index_position_)
    throw BagDamage("a chunk reaches into the index");
  if (compression == "none") {
    if (!open && size != length) throw BagDamage("a chunk has two lengths");
    chunk_ = file_.take(std::min(length, file_.left()), data_bytes_);
  } else {
    // Compressed data is never much longer.
    if (!open && length > size + size / 50 + 4096) throw BagDamage("a chunk has no possible length");
    if (chunk_is_cut_) throw BagCut("the last chunk is not whole");
    chunk_ = unpacked(file_.take(length, data_bytes_), compression, size);
  }
  rest_ = chunk_;
  in_chunk_ = true;
}

std::string_view BagWalk::unpacked(std::string_view data, const std::string& compression, std::size_t size) {
  const bool lz4 = compression == "lz4";
  if (!lz4 && compression != "bz2") throw BagDamage("a chunk is packed in no known way");
  if (lz4 && size > 255 * data.size())
    throw BagDamage("a chunk has no possible length");  // one byte expands to 255 at most
  if (plain_bytes_.size() < size) plain_bytes_.resize(size);
  try {
    streams_.getStream(lz4 ? rosbag::compression::LZ4 : rosbag::compression::BZ2)
        ->decompress(reinterpret_cast<std::uint8_t*>(plain_bytes_.data()), static_cast<unsigned int>(size),
                     reinterpret_cast<std::uint8_t*>(data_bytes_.data()), static_cast<unsigned int>(data.size()));
    return std::string_view(plain_bytes_).substr(0, size);
  } catch (const rosbag::BagException& error) {
    throw BagDamage(std::string("a chunk cannot be unpacked: ") + error.what());
  }
}

std::optional<RawMessage> BagWalk::take_from_chunk() {
  if (rest_.empty()) {
    in_chunk_ = false;
    if (chunk_is_cut_) throw BagCut("the last chunk is not whole");
    index_.end_chunk();
    return std::nullopt;
  }
  const auto offset = static_cast<std::uint32_t>(chunk_.size() - rest_.size());
  try {
    const Fields header = take_header(rest_);
    const std::uint32_t length = take_length(rest_);
    const RecordKind kind = header.kind();
    if (kind != RecordKind::message && kind != RecordKind::connection)
      throw BagDamage("a chunk contains an invalid record");
    const auto connection = header.number<std::uint32_t>("conn");
    const auto time = kind == RecordKind::message ? header.number<std::uint64_t>("time") : 0;
    if (kind == RecordKind::message && connections_.count(connection) == 0)
      throw BagDamage("a message has no connection");
    if (length > rest_.size()) {
      if (kind == RecordKind::message && !may_have_size(connections_.at(connection).type, rest_, length))
        throw BagDamage("the length of a message is not that of its content");
      throw BagCut("a record is cut off");
    }
    const std::string_view data = rest_.substr(0, length);
    rest_.remove_prefix(length);
    if (kind == RecordKind::message) {
      index_.add(connection, time, offset);
      const bool after_gap = std::exchange(gap_, false);
      return RawMessage{connection, nanoseconds(time), data, passing_over_, after_gap};
    }
    take_connection(header, data);
    return std::nullopt;
  } catch (const BagCut&) {
    if (!chunk_is_cut_) throw BagDamage("a record is longer than its chunk");
    throw;
  }
}

void BagWalk::take_connection(const Fields& header, std::string_view data) {
  const Fields fields(data);
  const std::string topic(header.text("topic"));
  if (topic.empty()) throw BagDamage("a connection has no topic");
  const auto [known, is_new] = connections_.try_emplace(
      header.number<std::uint32_t>("conn"),
      BagConnection{topic, std::string(data), std::string(fields.text("type")), std::string(fields.text("md5sum"))});
  if (!is_new && (known->second.topic != topic || Fields(known->second.fields) != fields))
    throw BagDamage("a connection has two meanings");
}

// Takes a record at the end of a closed file.
void BagWalk::take_summaries(const Fields& header, std::string_view data) {
  if (header.kind() == RecordKind::chunk_info) {
    if (!skipped_) index_.verify_summary(header, data);
    return;
  }
  if (header.kind() != RecordKind::connection) throw BagDamage("a record has no known kind");
  const auto connection = header.number<std::uint32_t>("conn");
  if (!skipped_ && connections_.count(connection) == 0) throw BagDamage("a connection has no messages");
  take_connection(header, data);
  if (!summarized_.insert(connection).second) throw BagDamage("a connection is there twice");
}

void BagWalk::require_whole() const {
  if (index_position_ == 0) throw BagCut("it was not closed");
  if (index_.without_summary() > 0 || summarized_.size() < connections_.size())
    throw BagCut("the end of its index is missing");
  if (summarized_.size() != connection_count_ || index_.chunks() != chunk_count_)
    throw BagDamage("its counts contradict its content");
}

}  // namespace platoon
