#pragma once

#include <ros/message_event.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace platoon {

/// Holds a receiver to one publisher of a topic within a run: the node whose message of that run came first, and
/// whatever is started again under its name. ROS hands on what anybody publishes, and what a second node says may
/// be in order, of the right size and of a new attempt.
///
/// It knows a node by the name that the node itself gives: this keeps out mistakes, a bag that is played, a node
/// left over, a test; not one that means to deceive.
class SolePublisher {
public:
  using Header = boost::shared_ptr<ros::M_string>;

  /// `what` the publishers share: a topic, resolved. `remark`: what there is to add where another is named.
  explicit SolePublisher(std::string what, std::string remark = {})
      : what_(std::move(what)), remark_(std::move(remark)) {}

  /// Whether a message of this run that came over a connection of this header counts. Says whose do not, at most
  /// once a second.
  bool admits(const Header& connection, std::uint64_t run) {
    return (connection == connection_ && run == run_) || looks_and_admits(connection, run);
  }

private:
  bool looks_and_admits(const Header& connection, std::uint64_t run);

  std::string what_, remark_;
  std::uint64_t run_ = 0;
  std::string name_;                 ///< of the node that counts
  Header connection_;                ///< its latest one; held, so that no other gets its address
  std::optional<double> last_said_;  ///< [s]
};

}  // namespace platoon
