#include "stochastic_platoon/bags/bag_stream.hpp"

#include "stochastic_platoon/bags/bag_reader.hpp"
#include "stochastic_platoon/bags/message_dispatch.hpp"

namespace platoon {

using stochastic_platoon::Position;

BagStream::BagStream(const std::vector<std::string>& files,
                     const std::function<bool(const PlatoonTopic&)>& wanted) {
  for (const std::string& file : files) {
    bags_.push_back(open_bag(file));
    view_.addQuery(*bags_.back(), [&wanted](const rosbag::ConnectionInfo* connection) {
      const std::optional<PlatoonTopic> topic = parse_topic(connection->topic);
      return topic && connection->datatype == ros::message_traits::datatype<Position>() && wanted(*topic);
    });
  }
  position_ = view_.begin();
}

std::optional<RecordedPosition> BagStream::next() {
  if (position_ == view_.end()) return std::nullopt;
  try {
    RecordedPosition recorded{*parse_topic(position_->getTopic()),
                              instantiated<Position>(*position_, buffer_)};
    ++position_;
    return recorded;
  } catch (const rosbag::BagException& reason) {
    throw BagError(std::string("the bag is damaged: ") + reason.what());
  } catch (const ros::serialization::StreamOverrunException& reason) {
    throw BagError(std::string("the bag holds a message that is cut off: ") + reason.what());
  }
}

}  // namespace platoon
