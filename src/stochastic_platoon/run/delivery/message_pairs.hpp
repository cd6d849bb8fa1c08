#pragma once

#include <cstdint>
#include <deque>

namespace platoon {

/// Pairs the messages of two topics that carry the same steps: the positions and the inputs of one predecessor. Each is
/// added in turn, so that neither has a gap within an attempt, and only messages of an older attempt or of another run
/// find no counterpart. Pointer: to a message with the fields run and attempt.
template <class Pointer>
class MessagePairs {
public:
  void add_position(const Pointer& message) { positions_.push_back(message); }
  void add_input(const Pointer& message) { inputs_.push_back(message); }

  /// Calls visit(position, input), both pointers, with every pair that is complete. `run`: the present run.
  template <class Visit>
  void visit(std::uint64_t run, const Visit& visit) {
    while (!positions_.empty() && !inputs_.empty()) {
      const Pointer position = positions_.front(), input = inputs_.front();
      const bool same_run = position->run == input->run;
      const bool is_pair = same_run && position->attempt == input->attempt;
      const bool position_is_older = same_run ? position->attempt < input->attempt : position->run != run;
      if (is_pair || position_is_older) positions_.pop_front();
      if (is_pair || !position_is_older) inputs_.pop_front();
      if (is_pair) visit(position, input);
    }
  }

private:
  std::deque<Pointer> positions_, inputs_;
};

}  // namespace platoon
