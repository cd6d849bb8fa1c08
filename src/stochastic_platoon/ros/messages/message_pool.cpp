#include "stochastic_platoon/ros/messages/message_pool.hpp"

#include <atomic>
#include <boost/make_shared.hpp>

namespace platoon {

using stochastic_platoon::Position;

Position::Ptr MessagePool::take() {
  for (const Position::Ptr& message : *messages_) {
    if (message.use_count() != 1) continue;
    std::atomic_thread_fence(std::memory_order_acquire);  // orders the last receiver's reads before our writes
    return message;
  }
  messages_->push_back(boost::make_shared<Position>());
  return messages_->back();
}

}  // namespace platoon
