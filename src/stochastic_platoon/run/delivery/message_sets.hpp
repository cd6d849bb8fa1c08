#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace platoon {

/// Collects the messages of one step from several topics, such as all inputs of a vehicle. Each topic's messages are
/// added in turn, so that none has a gap within an attempt, and only messages of an older attempt or of another run
/// find no counterpart. Pointer: to a message with the fields run and attempt.
template <class Pointer>
class MessageSets {
public:
  explicit MessageSets(std::size_t topics) : waiting_(topics) {}

  void add(std::size_t topic, const Pointer& message) {
    // Where another topic is silent, each attempt would leave its messages: those of the latest two suffice.
    std::deque<Pointer>& messages = waiting_[topic];
    if (!messages.empty() && messages.back()->run == message->run && messages.back()->attempt < message->attempt) {
      const auto kept = messages.back()->attempt;
      while (messages.front()->run == message->run && messages.front()->attempt < kept) messages.pop_front();
    }
    messages.push_back(message);
  }

  /// Calls visit(set) with every complete set, one message per topic in their order. `run`: the present run.
  template <class Visit>
  void visit(std::uint64_t run, const Visit& visit) {
    const auto is_empty = [](const std::deque<Pointer>& messages) { return messages.empty(); };
    while (std::none_of(waiting_.begin(), waiting_.end(), is_empty)) {
      std::vector<Pointer> set = take_those_that_match(run);
      if (set.size() == waiting_.size()) visit(set);
    }
  }

private:
  // Takes the first message of each topic that is as new as any other, and drops the others.
  std::vector<Pointer> take_those_that_match(std::uint64_t run) {
    const auto& first = *waiting_.front().front();
    bool same_run = true;
    auto newest = first.attempt;
    for (const auto& messages : waiting_) {
      same_run = same_run && messages.front()->run == first.run;
      newest = std::max(newest, messages.front()->attempt);
    }
    const auto matches = [&](const auto& message) {
      return same_run ? message->attempt == newest : message->run == run;
    };
    const bool complete =
        std::all_of(waiting_.begin(), waiting_.end(), [&](const auto& messages) { return matches(messages.front()); });
    std::vector<Pointer> set;
    for (auto& messages : waiting_) {
      if (!complete && matches(messages.front())) continue;
      if (complete) set.push_back(messages.front());
      messages.pop_front();
    }
    return set;
  }

  std::vector<std::deque<Pointer>> waiting_;
};

}  // namespace platoon
