#include "stochastic_platoon/ros/bags/bag_writer.hpp"

#include <std_msgs/String.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cstdio>
#include <filesystem>
#include <utility>
#include <vector>

#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/xxhash64.hpp"

namespace platoon {

namespace {

constexpr std::uint32_t kChunkBytes = 1u << 20;
constexpr std::uint64_t kCovered = 1u << 14;        // bytes per checksum, at least
constexpr std::uint64_t kCoveredAtMost = 1u << 24;  // bytes, plus one message

// The digests that msg/Checksum.msg defines.

template <typename Message>
std::uint64_t message_digest(const Message& message, std::uint64_t seed) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  Xxhash64 hash(seed);
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

// The same, without a copy of its positions.
std::uint64_t message_digest(const stochastic_platoon::Position& message, std::uint64_t seed) {
  constexpr std::size_t kFixed = 8 + 4 + 8 + 8 + 4;
  const std::uint32_t header = ros::serialization::serializationLength(message.header);
  std::vector<std::uint8_t> bytes(header + kFixed);
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  stream.next(message.header);
  stream.next(message.run);
  stream.next(message.attempt);
  stream.next(message.first_realization);
  stream.next(message.step);
  stream.next(static_cast<std::uint32_t>(message.position.size()));
  Xxhash64 hash(seed);
  hash.add(bytes.data(), bytes.size());
  hash.add(message.position.data(), message.position.size() * sizeof(double));
  return hash.value();
}

}  // namespace

BagWriter::BagWriter(std::string name, const std::string& suffix, const std::string& compression,
                     const RecordedConfiguration& configuration)
    : name_(std::move(name)), suffix_(suffix) {
  try {
    bag_->open(name_ + suffix_, rosbag::bagmode::Write);
    begin(compression, configuration);
  } catch (...) {
    abandon();
    throw;
  }
}

BagWriter::~BagWriter() {
  if (!bag_) return;
  try {
    bag_->close();
  } catch (const std::exception&) {
    abandon();
  }
}

void BagWriter::begin(const std::string& compression, const RecordedConfiguration& configuration) {
  write_behind_.emplace(name_ + suffix_);
  bag_->setChunkThreshold(kChunkBytes);
  if (compression == "lz4") bag_->setCompression(rosbag::compression::LZ4);
  const auto header = boost::make_shared<ros::M_string>();
  (*header)["callerid"] = "/recorder";
  (*header)["latching"] = "1";
  (*header)["md5sum"] = ros::message_traits::md5sum<std_msgs::String>();
  (*header)["message_definition"] = ros::message_traits::definition<std_msgs::String>();
  (*header)["topic"] = configuration.topic;
  (*header)["type"] = ros::message_traits::datatype<std_msgs::String>();
  std_msgs::String message;
  message.data = configuration.json;
  bag_->write(configuration.topic, ros::TIME_MIN, message, header);
  checksum_topic_ = configuration.topic.substr(0, configuration.topic.rfind('/') + 1) + kChecksumTopic;
  cover(configuration.topic, ros::TIME_MIN, message);
  write_checksum();
}

void BagWriter::write(const std::string& topic, const stochastic_platoon::Position& message) {
  record(topic, std::clamp(message.header.stamp, ros::TIME_MIN, ros::TIME_MAX), message);
}

void BagWriter::write(const std::string& topic, const stochastic_platoon::ErrorStatistics& message) {
  record(topic, latest_, message);
}

void BagWriter::end_step(bool is_last) {
  if (is_last || uncovered_bytes_ >= kCovered) write_checksum();
}

template <typename Message>
void BagWriter::record(const std::string& topic, const ros::Time& time, const Message& message) {
  if (uncovered_bytes_ >= kCoveredAtMost) write_checksum();
  bag_->write(topic, time, message);
  cover(topic, time, message);
  write_behind_->advance(bag_->getSize());
}

template <typename Message>
void BagWriter::cover(const std::string& topic, const ros::Time& time, const Message& message) {
  checksum_.digest += message_digest(message, xxhash64(topic) + time.toNSec());
  ++checksum_.messages;
  uncovered_bytes_ += ros::serialization::serializationLength(message);
  latest_ = std::max(latest_, time);
}

// The time of a checksum lies after all messages that it covers and before all that follow.
void BagWriter::write_checksum() {
  if (uncovered_bytes_ == 0) return;
  const ros::Duration nanosecond(0, 1);
  const ros::Time time = later(latest_, nanosecond);
  bag_->write(checksum_topic_, time, checksum_);
  latest_ = later(time, nanosecond);
  checksum_.digest = 0;
  uncovered_bytes_ = 0;
}

void BagWriter::close() {
  write_checksum();
  closed_bytes_ = bytes();
  bag_->close();
  write_behind_->finish();
}

// rosbag writes its index when it closes a file, also in its destructor, where a failure ends the program. A compressor
// that has failed once fails there again: such a bag lives as long as the program.
void BagWriter::abandon() noexcept try {
  if (!bag_) return;
  closed_bytes_ = bytes();
  if (!write_behind_) write_behind_.emplace(name_ + suffix_);  // the first bytes of the file could not be written
  write_behind_->divert_others();
  bag_->close();
  write_behind_->finish();
} catch (...) {
  static auto* const never_closed = new std::vector<std::unique_ptr<rosbag::Bag>>;
  never_closed->push_back(std::move(bag_));
}

void BagWriter::complete() {
  close();
  sync_and_rename(name_ + suffix_, name_);
}

void BagWriter::set_suffix(const std::string& suffix) {
  if (std::rename((name_ + suffix_).c_str(), (name_ + suffix).c_str()) != 0) {
    throw std::runtime_error(name_ + suffix_ + ": cannot be renamed to " + name_ + suffix);
  }
  suffix_ = suffix;
}

std::string name_put_aside(const std::string& name, std::size_t count) {
  return name + kActiveSuffix + "." + std::to_string(count);
}

std::string left_recording(const std::string& name) {
  for (const std::string& file : {name, name + kActiveSuffix, name_put_aside(name, 1)}) {
    if (std::filesystem::exists(file)) return file;
  }
  return "";
}

std::string left_part(const std::string& name) {
  const std::filesystem::path path(name);
  const std::string begin = path.stem().string() + "_";
  const auto is_part = [&begin](const std::string& file) {
    if (file.compare(0, begin.size(), begin) != 0) return false;
    const std::size_t end = std::min(file.find_first_not_of("0123456789", begin.size()), file.size());
    const std::string extension = file.substr(end), active = std::string(".bag") + kActiveSuffix;
    return end > begin.size() && (extension == ".bag" || extension.compare(0, active.size(), active) == 0);
  };
  std::string first;
  for (const auto& entry : std::filesystem::directory_iterator(path.parent_path())) {
    const std::string file = entry.path().filename().string();
    if (is_part(file) && (first.empty() || file < first)) first = file;
  }
  return first.empty() ? "" : (path.parent_path() / first).string();
}

std::string overwritten(const std::string& record, bool in_parts) {
  std::string left = left_recording(record);
  if (left.empty()) left = left_recording(std::filesystem::path(record).replace_extension().string() + "_0.bag");
  return left.empty() && in_parts ? left_part(record) : left;
}

void require_free_recording(const std::string& record, bool in_parts) {
  if (record.empty()) return;
  if (record.size() <= 4 || record.substr(record.size() - 4) != ".bag") {
    throw ConfigurationError({"record: " + record + ": must be a file name that ends in .bag"});
  }
  try {
    require_writable_folder(std::filesystem::path(record).parent_path().string());
  } catch (const std::runtime_error& error) {
    throw ConfigurationError({std::string("record: ") + error.what() + ": must be in a folder that can be written"});
  }
  try {
    if (const std::string left = overwritten(record, in_parts); !left.empty())
      throw ConfigurationError({"record: " + left + ": exists: must be a new file"});
  } catch (const std::filesystem::filesystem_error& error) {
    throw ConfigurationError(
        {"record: " + error.path1().string() + ": " + error.code().message() + ": must be a new file"});
  }
}

}  // namespace platoon
