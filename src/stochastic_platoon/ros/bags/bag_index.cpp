#include "stochastic_platoon/ros/bags/bag_index.hpp"

#include <algorithm>
#include <array>

#include "stochastic_platoon/run/io/xxhash64.hpp"

namespace platoon {

namespace {

// rosbag sorts index entries by time; BagIndex collects them in the order of the file.
std::vector<std::string> sorted_entries(std::string_view bytes) {
  std::vector<std::string> entries;
  for (; !bytes.empty(); bytes.remove_prefix(kIndexEntry)) entries.emplace_back(bytes.substr(0, kIndexEntry));
  std::sort(entries.begin(), entries.end());
  return entries;
}

// Times are 32-bit seconds and 32-bit nanoseconds; to compare, the seconds become the upper half.
std::uint64_t comparable(std::uint64_t time) {
  return (time << 32) | (time >> 32);
}

}  // namespace

void BagIndex::begin_chunk(std::uint64_t position) {
  require_complete();
  chunk_ = Chunk();
  chunk_.position = position;
  for (auto& entry : entries_) entry.second.clear();
}

void BagIndex::add(std::uint32_t connection, std::uint64_t time, std::uint32_t offset) {
  if (chunk_.counts.empty()) chunk_.first_time = chunk_.last_time = time;
  if (comparable(time) < comparable(chunk_.first_time)) chunk_.first_time = time;
  if (comparable(time) > comparable(chunk_.last_time)) chunk_.last_time = time;
  ++chunk_.counts[connection];
  std::array<char, kIndexEntry> entry;
  std::memcpy(entry.data(), &time, sizeof time);
  std::memcpy(entry.data() + sizeof time, &offset, sizeof offset);
  entries_[connection].append(entry.data(), entry.size());
}

void BagIndex::end_chunk() {
  unverified_ = chunk_.counts.size();
  summaries_.push_back(digest_of(chunk_));
}

void BagIndex::verify(const Fields& header, std::string_view entries) {
  const auto found = entries_.find(header.number<std::uint32_t>("conn"));
  if (header.number<std::uint32_t>("ver") != 1 || found == entries_.end() || found->second.empty() ||
      entries.size() != std::uint64_t{kIndexEntry} * header.number<std::uint32_t>("count") ||
      entries.size() != found->second.size() ||
      (entries != found->second && sorted_entries(entries) != sorted_entries(found->second))) {
    throw BagDamage("the index is not that of the messages");
  }
  found->second.clear();
  --unverified_;
}

void BagIndex::require_complete() const {
  if (unverified_ > 0) throw BagDamage("a part of the index is missing");
}

void BagIndex::verify_summary(const Fields& header, std::string_view counts) {
  Chunk chunk;
  chunk.position = header.number<std::uint64_t>("chunk_pos");
  chunk.first_time = header.number<std::uint64_t>("start_time");
  chunk.last_time = header.number<std::uint64_t>("end_time");
  const bool whole = counts.size() == std::uint64_t{kSummaryEntry} * header.number<std::uint32_t>("count");
  for (; whole && !counts.empty(); counts.remove_prefix(kSummaryEntry))
    chunk.counts[little_endian<std::uint32_t>(counts.data())] = little_endian<std::uint32_t>(counts.data() + 4);
  if (!whole || header.number<std::uint32_t>("ver") != 1 || without_summary() == 0 ||
      digest_of(chunk) != summaries_[verified_]) {
    throw BagDamage("the summary of a chunk is not that of its messages");
  }
  ++verified_;
}

std::uint64_t BagIndex::digest_of(const Chunk& chunk) {
  Xxhash64 hash;
  for (const std::uint64_t number : {chunk.position, chunk.first_time, chunk.last_time})
    hash.add(&number, sizeof number);
  for (const auto& [connection, count] : chunk.counts) {
    hash.add(&connection, sizeof connection);
    hash.add(&count, sizeof count);
  }
  return hash.value();
}

}  // namespace platoon
