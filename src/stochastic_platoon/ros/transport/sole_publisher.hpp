#pragma once

#include <ros/message_event.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace platoon {

/// Limits a receiver to one publisher of a topic within a run: the node whose message of that run arrives first, or a
/// restarted node of the same name. ROS delivers the messages of every publisher, and those of a second node may be in
/// order, of the right size and of a new attempt.
///
/// A node is identified by the name that it gives itself. This protects against mistakes (a bag that is played, a
/// leftover node, a test), not against deception.
class SolePublisher {
public:
  using Header = boost::shared_ptr<ros::M_string>;

  /// `topic`: resolved. `remark`: text appended when a second publisher is logged.
  explicit SolePublisher(std::string topic, std::string remark = {})
      : topic_(std::move(topic)), remark_(std::move(remark)) {}

  /// Whether a message of this run over a connection with this header counts. Logs rejected publishers, at most once a
  /// second.
  bool admits(const Header& connection, std::uint64_t run) {
    return (connection == connection_ && run == run_) || looks_and_admits(connection, run);
  }

private:
  bool looks_and_admits(const Header& connection, std::uint64_t run);

  std::string topic_, remark_;
  std::uint64_t run_ = 0;
  std::string name_;                   ///< of the accepted node
  Header connection_;                  ///< its latest one; kept alive so that no other header gets its address
  std::optional<double> last_logged_;  ///< [s]
};

}  // namespace platoon
