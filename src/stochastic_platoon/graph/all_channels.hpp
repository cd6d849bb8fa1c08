#pragma once

#include <ros/node_handle.h>

#include <cstdint>

#include "stochastic_platoon/graph/channel.hpp"
#include "stochastic_platoon/graph/receiving_thread.hpp"

namespace platoon {

/// The channels into all followers, in the thread that receives their messages.
class AllChannels {
public:
  AllChannels(ros::NodeHandle platoon, const Configuration& configuration)
      : channel_(on(platoon, &thread_), configuration, 1,
                 static_cast<std::uint32_t>(configuration.run.followers), MessagePool()) {}

private:
  static ros::NodeHandle on(ros::NodeHandle platoon, ReceivingThread* thread) {
    platoon.setCallbackQueue(thread);
    return platoon;
  }

  ReceivingThread thread_;
  Channel channel_;
};

}  // namespace platoon
