#pragma once

#include <stochastic_platoon/Position.h>

#include <memory>
#include <vector>

namespace platoon {

/// Messages to publish, used again once every receiver has released them: in steady state none is allocated,
/// and their arrays keep their size. Holds as many as were in flight at once, which credit bounds.
///
/// Copies share the messages. For the components of one thread, whose caches then hold few of them; the
/// receivers may be on others.
class MessagePool {
public:
  /// A message that nobody else holds.
  stochastic_platoon::Position::Ptr take();

  /// Messages made so far.
  std::size_t size() const { return messages_->size(); }

private:
  using Messages = std::vector<stochastic_platoon::Position::Ptr>;
  std::shared_ptr<Messages> messages_ = std::make_shared<Messages>();
};

}  // namespace platoon
