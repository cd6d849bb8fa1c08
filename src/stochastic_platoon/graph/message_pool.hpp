#pragma once

#include <stochastic_platoon/Position.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <cstddef>
#include <vector>

namespace platoon {

/// Messages to publish, used again once every receiver has let go of them: in steady state none is allocated,
/// and their arrays keep their size. Holds as many as were on their way at once, which credit bounds. For one
/// thread; the receivers may be others.
class MessagePool {
public:
  stochastic_platoon::Position::Ptr take() {
    for (std::size_t tried = 0; tried < messages_.size(); ++tried) {
      next_ = (next_ + 1) % messages_.size();
      if (messages_[next_].use_count() != 1) continue;
      std::atomic_thread_fence(std::memory_order_acquire);  // what the last receiver read, it has read
      return messages_[next_];
    }
    messages_.push_back(boost::make_shared<stochastic_platoon::Position>());
    next_ = messages_.size() - 1;
    return messages_.back();
  }

private:
  std::vector<stochastic_platoon::Position::Ptr> messages_;
  std::size_t next_ = 0;
};

}  // namespace platoon
