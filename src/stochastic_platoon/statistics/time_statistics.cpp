#include "stochastic_platoon/statistics/time_statistics.hpp"

#include <algorithm>

namespace platoon {

void TimeStatistics::add(const ReducedErrors& errors) {
  Follower& follower = followers_.at(errors.follower - 1);
  follower.early.emplace(errors.step, errors.nodes.front().mean);  // of one realization: the error itself
  for (auto next = follower.early.begin(); next != follower.early.end() && next->first == follower.next_step;
       next = follower.early.erase(next), ++follower.next_step) {
    if (next->first >= burn_in_) follower.moments.add(next->second);
  }
}

std::int64_t TimeStatistics::last_step() const {
  std::int64_t last = -1;
  for (const Follower& follower : followers_) last = std::max(last, follower.next_step - 1);
  return last;
}

std::vector<Moments> TimeStatistics::moments() const {
  std::vector<Moments> all;
  for (const Follower& follower : followers_) all.push_back(follower.moments);
  return all;
}

}  // namespace platoon
