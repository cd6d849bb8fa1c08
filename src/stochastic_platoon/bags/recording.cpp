#include "stochastic_platoon/bags/recording.hpp"

#include <std_msgs/String.h>

#include <boost/make_shared.hpp>
#include <cstdio>
#include <utility>

#include "stochastic_platoon/results/atomic_file.hpp"

namespace platoon {

namespace {

constexpr std::uint32_t kChunkBytes = 4u << 20;

}  // namespace

std::string part_name(const RecordingOptions& options, std::size_t part) {
  if (options.split_bytes == 0) return options.file;
  return options.file.substr(0, options.file.size() - 4) + "_" + std::to_string(part) + ".bag";
}

Recording::Recording(const RecordingOptions& options, std::string configuration_topic,
                     std::string configuration, std::size_t part, const std::string& suffix)
    : options_(options),
      configuration_topic_(std::move(configuration_topic)),
      configuration_(std::move(configuration)),
      part_(part),
      suffix_(suffix) {
  open();
}

void Recording::open() {
  bag_.open(part_name(options_, part_) + suffix_, rosbag::bagmode::Write);
  write_behind_ = WriteBehind(part_name(options_, part_) + suffix_);
  bag_.setChunkThreshold(kChunkBytes);
  if (options_.compression == "lz4") bag_.setCompression(rosbag::compression::LZ4);
  const auto header = boost::make_shared<ros::M_string>();
  (*header)["callerid"] = "/recorder";
  (*header)["latching"] = "1";
  (*header)["md5sum"] = ros::message_traits::md5sum<std_msgs::String>();
  (*header)["message_definition"] = ros::message_traits::definition<std_msgs::String>();
  (*header)["topic"] = configuration_topic_;
  (*header)["type"] = ros::message_traits::datatype<std_msgs::String>();
  std_msgs::String message;
  message.data = configuration_;
  bag_.write(configuration_topic_, ros::TIME_MIN, message, header);
}

void Recording::between_batches() {
  if (options_.split_bytes == 0 || bag_.getSize() < options_.split_bytes) return;
  complete();
  ++part_;
  open();
}

void Recording::complete() {
  finished_bytes_ += bag_.getSize();
  bag_.close();
  const std::string name = part_name(options_, part_);
  sync_and_rename(name + suffix_, name);
}

void Recording::set_suffix(const std::string& suffix) {
  const std::string name = part_name(options_, part_);
  if (std::rename((name + suffix_).c_str(), (name + suffix).c_str()) != 0) {
    throw std::runtime_error(name + suffix_ + ": cannot be renamed to " + name + suffix);
  }
  suffix_ = suffix;
}

}  // namespace platoon
