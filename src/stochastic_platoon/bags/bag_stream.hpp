#pragma once

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <stochastic_platoon/Position.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/messages/topics.hpp"

namespace platoon {

/// One recorded message of a vehicle, the reader's own.
struct RecordedPosition {
  PlatoonTopic topic;
  stochastic_platoon::Position::Ptr message;
};

/// The positions of closed bags, one at a time in the order of the recorded times: for those who must not
/// read ahead. Throws BagError as read_bags() does.
class BagStream {
public:
  /// Of the topics that `wanted` wants.
  BagStream(const std::vector<std::string>& files, const std::function<bool(const PlatoonTopic&)>& wanted);

  /// The next one; none at the end.
  std::optional<RecordedPosition> next();

private:
  std::vector<std::unique_ptr<rosbag::Bag>> bags_;
  rosbag::View view_;
  rosbag::View::iterator position_;
  std::string buffer_;
};

}  // namespace platoon
