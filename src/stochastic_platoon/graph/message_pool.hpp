#pragma once

#include <stochastic_platoon/Position.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <memory>
#include <vector>

namespace platoon {

/// Messages to publish, used again once every receiver has let go of them: in steady state none is allocated,
/// and their arrays keep their size. Holds as many as were on their way at once, which credit bounds.
///
/// Copies share the messages. For the components of one thread, whose caches then hold few of them; the
/// receivers may be on others.
class MessagePool {
public:
  stochastic_platoon::Position::Ptr take() {
    for (const stochastic_platoon::Position::Ptr& message : *messages_) {
      if (message.use_count() != 1) continue;
      std::atomic_thread_fence(std::memory_order_acquire);  // what the last receiver read, it has read
      return message;
    }
    messages_->push_back(boost::make_shared<stochastic_platoon::Position>());
    return messages_->back();
  }

private:
  using Messages = std::vector<stochastic_platoon::Position::Ptr>;
  std::shared_ptr<Messages> messages_ = std::make_shared<Messages>();
};

}  // namespace platoon
