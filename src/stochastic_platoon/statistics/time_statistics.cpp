#include "stochastic_platoon/statistics/time_statistics.hpp"

#include <algorithm>

namespace platoon {

TimeStatistics::TimeStatistics(std::size_t followers, std::int64_t burn_in, std::vector<Moments> earlier)
    : burn_in_(burn_in), earlier_(std::move(earlier)), followers_(followers) {
  earlier_.resize(followers);
}

void TimeStatistics::restart() {
  earlier_ = moments();
  followers_.assign(followers_.size(), Follower{});
}

void TimeStatistics::add(const ReducedErrors& errors) {
  Follower& follower = followers_.at(errors.follower - 1);
  follower.early.emplace(errors.step, errors.nodes.front().mean);  // of one realization: the error itself
  for (auto next = follower.early.begin(); next != follower.early.end() && next->first == follower.next_step;
       next = follower.early.erase(next), ++follower.next_step) {
    if (next->first >= burn_in_) follower.moments.add(next->second);
  }
}

bool TimeStatistics::empty() const {
  return last_step() < 0 && std::all_of(earlier_.begin(), earlier_.end(),
                                        [](const Moments& moments) { return moments.count == 0; });
}

std::int64_t TimeStatistics::last_step() const {
  std::int64_t last = -1;
  for (const Follower& follower : followers_) last = std::max(last, follower.next_step - 1);
  return last;
}

std::vector<Moments> TimeStatistics::moments() const {
  std::vector<Moments> all;
  for (std::size_t i = 0; i < followers_.size(); ++i)
    all.push_back(merge(earlier_[i], followers_[i].moments));
  return all;
}

}  // namespace platoon
