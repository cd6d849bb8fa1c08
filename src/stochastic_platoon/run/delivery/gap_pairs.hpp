#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"
#include "stochastic_platoon/run/delivery/message_sets.hpp"

namespace platoon {

/// Pairs the messages that a link sends with the positions of its two ends one step earlier, for losses that depend on
/// the gap. All three topics are added in turn, as MessageSets requires. The message of step -1 needs no ends.
/// Pointer: to a message with the fields run, attempt, first_realization, step and position.
template <class Pointer>
class GapPairs {
public:
  void add_sent(const Pointer& message) {
    // A waiting message of an older attempt would block this one, and with it the vehicle behind the link.
    while (!sent_.empty() && (sent_.front()->run != message->run || sent_.front()->attempt != message->attempt))
      sent_.pop_front();
    sent_.push_back(message);
  }
  void add_predecessor(const Pointer& message) { ends_.add(0, message); }
  void add_own(const Pointer& message) { ends_.add(1, message); }

  /// Calls visit(sent, predecessor, own) with every message that can be sent; the latter two are null at step -1.
  /// `run`: the present run.
  template <class Visit>
  void visit(std::uint64_t run, const Visit& visit) {
    ends_.visit(run, [this](const std::vector<Pointer>& ends) { earlier_.push_back({ends[0], ends[1]}); });
    while (!sent_.empty()) {
      const Pointer sent = sent_.front();
      if (sent->step == kInitialStep) {
        sent_.pop_front();
        visit(*sent, nullptr, nullptr);
        continue;
      }
      if (earlier_.empty()) return;
      const Pair before = earlier_.front();
      const auto order = compared(*sent, *before.own, run);
      if (order <= 0) sent_.pop_front();
      if (order >= 0) earlier_.pop_front();
      if (order == 0) visit(*sent, &*before.predecessor, &*before.own);
    }
  }

private:
  struct Pair {
    Pointer predecessor, own;
  };

  // Below 0: the sent message has missed its positions; above 0: the positions have missed their message; 0: they
  // match.
  template <class Message>
  static int compared(const Message& sent, const Message& before, std::uint64_t run) {
    if (sent.run != before.run) return before.run == run ? -1 : 1;
    if (sent.attempt != before.attempt) return sent.attempt < before.attempt ? -1 : 1;
    if (sent.first_realization != before.first_realization)
      return sent.first_realization < before.first_realization ? -1 : 1;
    return sent.step < before.step + 1 ? -1 : sent.step > before.step + 1 ? 1 : 0;
  }

  MessageSets<Pointer> ends_{2};  ///< of the predecessor and its own
  std::deque<Pair> earlier_;
  std::deque<Pointer> sent_;
};

}  // namespace platoon
