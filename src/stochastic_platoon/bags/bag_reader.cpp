#include "stochastic_platoon/bags/bag_reader.hpp"

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <sstream>

#include "stochastic_platoon/bags/message_dispatch.hpp"

namespace platoon {

namespace {

template <typename Message>
bool is_type(const std::string& type, const std::string& md5) {
  return type == ros::message_traits::datatype<Message>() && md5 == ros::message_traits::md5sum<Message>();
}

}  // namespace

std::unique_ptr<rosbag::Bag> open_bag(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw BagError(file + ": must be a bag file that can be read");
  try {
    return std::make_unique<rosbag::Bag>(file, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw BagError(
        file +
        ": was not closed (its recorder was killed, or is still running): only its readable part can be had");
  } catch (const std::exception& reason) {
    throw BagError(file + ": is damaged or no bag: " + reason.what());
  }
}

std::vector<std::string> bag_files(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), std::istream_iterator<std::string>()};
}

TopicReading reading_of(const BagContent& content, const std::string& name, const std::string& type,
                        const std::string& md5) {
  const std::optional<PlatoonTopic> topic = parse_topic(name);
  if (!topic) return {};
  using Kind = PlatoonTopic::Kind;
  switch (topic->kind) {
    case Kind::position:
      return is_type<stochastic_platoon::Position>(type, md5) ? TopicReading{topic, bool(content.position)}
                                                              : TopicReading{};
    case Kind::predecessor_position:
      return is_type<stochastic_platoon::Position>(type, md5)
                 ? TopicReading{topic, bool(content.predecessor_position)}
                 : TopicReading{};
    case Kind::error_statistics:
      return is_type<stochastic_platoon::ErrorStatistics>(type, md5)
                 ? TopicReading{topic, bool(content.error_statistics)}
                 : TopicReading{};
    case Kind::configuration:
      return is_type<std_msgs::String>(type, md5) ? TopicReading{topic, bool(content.configuration)}
                                                  : TopicReading{};
  }
  return {};
}

BagRemainder read_bags(const std::vector<std::string>& files, const BagContent& content) {
  BagRemainder remainder;
  std::map<std::string, PlatoonTopic> wanted;
  const auto is_wanted = [&](const rosbag::ConnectionInfo* connection) {
    const TopicReading reading =
        reading_of(content, connection->topic, connection->datatype, connection->md5sum);
    if (!reading.topic) remainder.foreign_topics.insert(connection->topic);
    if (reading.wanted) wanted.emplace(connection->topic, *reading.topic);
    return reading.wanted;
  };
  std::vector<std::unique_ptr<rosbag::Bag>> bags;
  rosbag::View view;
  try {
    for (const std::string& file : files) {
      bags.push_back(open_bag(file));
      view.addQuery(*bags.back(), is_wanted);
    }
    const std::uint64_t total = view.size();
    std::string buffer;
    std::uint64_t done = 0;
    for (const rosbag::MessageInstance& instance : view) {
      dispatch(content, wanted.at(instance.getTopic()), [&instance, &buffer](auto message) {
        return instantiated<decltype(message)>(instance, buffer);
      });
      ++done;
      if (content.progress && (done % 256 == 0 || done == total)) content.progress(done, total);
    }
  } catch (const rosbag::BagException& reason) {
    throw BagError(files.front() + ": is damaged: " + reason.what());
  } catch (const ros::serialization::StreamOverrunException& reason) {
    throw BagError(files.front() + ": holds a message that is cut off: " + reason.what());
  }
  return remainder;
}

}  // namespace platoon
