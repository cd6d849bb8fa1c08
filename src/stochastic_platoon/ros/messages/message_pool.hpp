#pragma once

#include <stochastic_platoon/Position.h>

#include <memory>
#include <vector>

namespace platoon {

/// Messages to publish, reused after all receivers have released them: in steady state none is allocated, and the
/// arrays keep their size. The pool grows to the largest number in flight, which credit bounds.
///
/// Copies share the messages. Use one pool per thread, so that its caches hold few messages; receivers may be on other
/// threads.
class MessagePool {
public:
  /// A message without other owners.
  stochastic_platoon::Position::Ptr take();

private:
  using Messages = std::vector<stochastic_platoon::Position::Ptr>;
  std::shared_ptr<Messages> messages_ = std::make_shared<Messages>();
};

}  // namespace platoon
