#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>
#include <stochastic_platoon/Progress.h>

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/bags/bag_stream.hpp"
#include "stochastic_platoon/ros/transport/message_counter.hpp"
#include "stochastic_platoon/ros/transport/notice_senders.hpp"
#include "stochastic_platoon/ros/transport/sole_publisher.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/replay_credit.hpp"

namespace platoon {

/// Sends the recorded values of all its inputs to one live follower and compares its answers with the recorded ones,
/// bit by bit; for an external vehicle it measures their largest distance. The messages are those of the present run.
///
/// If an answer is missing, or one of an external vehicle has another size or a NaN, the replay repeats its batch under
/// a newer attempt, as the leader does (see ReplayCredit): a link may be up at one end only, and a vehicle may be
/// killed. The replay ends with a verdict or, after `patience` without a new answer, with the reason why there is none.
///
/// Subscribes: `vehicle_<i>/position`, and `vehicle_<i>/input` if a vehicle behind hears it
/// (stochastic_platoon/Position), progress (stochastic_platoon/Progress: messages
/// that the vehicle has missed). Publishes: received_topic() of all its inputs, `vehicle_<i>/predecessor_position` of
/// the paper's (stochastic_platoon/Position).
class VehicleReplay {
public:
  /// `patience` [s] > 0. Throws std::invalid_argument if the run has no follower of this number, and std::runtime_error
  /// if the bags hold no position of it.
  VehicleReplay(ros::NodeHandle platoon, const Configuration& configuration, const BagSource& bags, std::size_t vehicle,
                bool external, double patience);

  /// There is a verdict, or a reason why there is none.
  bool done() const { return done_; }

  /// "vehicle_3: 2020 messages equal the recorded ones to the bit", or the first message that differs; for an external
  /// vehicle the largest distance of its positions, and of its inputs, from them. Or the reason why there is no
  /// verdict.
  std::string verdict() const;
  bool equal() const { return done_ && difference_.empty() && reason_.empty(); }

private:
  /// The vehicle's answers on one topic.
  struct Answers {
    std::string topic;
    const char* noun;  ///< "positions"
    const char* unit;
    SolePublisher publisher;
    MessageCounter counter;
    ros::Subscriber subscriber = {};
    std::optional<BagStream> stream = {};
    stochastic_platoon::Position::Ptr expected = {};  ///< next answer; none at the end
    std::int64_t compared = 0;                        ///< recorded answers before the expected one
    double largest = 0.0;                             ///< largest distance of an external vehicle's from the recorded
  };

  void open();
  void listen(ros::NodeHandle& platoon, const std::string& topic, const char* noun, const char* unit);
  void play();
  void send_allowed();
  void read_next();
  void begin_again();
  bool is_linked();
  void check_patience();
  void receive(Answers& answers, const PositionEvent& event);
  void receive_notice(const ros::MessageEvent<const stochastic_platoon::Progress>& event);
  DropReason fault_of(const Answers& answers, const stochastic_platoon::Position& live) const;
  void judge(Answers& answers, const stochastic_platoon::Position& live);
  void compare(Answers& answers, const stochastic_platoon::Position& live);
  const Answers& last_behind() const;
  MessageId expected_id(const Answers& answers) const;
  std::string silence() const;
  void end_with(const std::string& reason);

  std::string name_;
  std::uint64_t run_;
  bool external_;
  double patience_;  ///< [s]
  BagSource bags_;
  std::size_t vehicle_;
  ReplayCredit credit_;
  /// The recorded messages that the vehicle receives over one link.
  struct Sent {
    std::string topic;
    ros::Publisher publisher;
    std::optional<BagStream> stream = {};
    stochastic_platoon::Position::Ptr next = {};  ///< next one to send; none at the end
  };
  std::vector<Sent> sent_;            ///< all inputs, step by step
  std::deque<Answers> answers_;       ///< positions, and inputs if a vehicle behind hears them, step by step
  std::int64_t batch_start_ = 0;      ///< recorded answers before the batch of the expected one
  std::uint32_t attempts_ahead_ = 0;  ///< attempt of this replay minus the recorded one
  std::uint32_t last_attempt_ = 0;    ///< latest attempt sent
  std::string difference_;            ///< the first difference
  std::string reason_;                ///< why there is no verdict
  bool done_ = false;
  bool waiting_ = false;         ///< for the vehicle, as last logged
  std::optional<double> began_;  ///< [s] first check of the links
  NoticeSenders notice_senders_;
  ros::Subscriber progress_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
