#include "stochastic_platoon/math/statistics/time_statistics.hpp"

#include <algorithm>

namespace platoon {

namespace {
constexpr std::int64_t kBeforeAll = -2;
}

TimeStatistics::TimeStatistics(std::size_t followers, std::int64_t burn_in, std::vector<Moments> earlier)
    : burn_in_(burn_in),
      counts_from_(burn_in),
      earlier_(std::move(earlier)),
      followers_(followers),
      batches_(followers) {
  earlier_.resize(followers);
}

void TimeStatistics::restart() {
  earlier_ = moments();
  followers_.assign(followers_.size(), Follower{});
  if (leader_step_ != kNever) leader_step_ = kBeforeAll;
  departed_ = kNever;
  counts_from_ = burn_in_;
}

void TimeStatistics::saw_leader(std::int64_t step, bool by_model) {
  leader_step_ = step;
  if (!by_model) {
    if (departed_ == kNever || step >= counts_from_) {
      departed_ = step;
      counted_from_ = counts_from_;
    }
    counts_from_ = std::max(counts_from_, step + 1 + burn_in_);
  }
  for (std::size_t i = 1; i <= followers_.size(); ++i) count_due(i);
}

bool TimeStatistics::counts(std::size_t follower, std::int64_t step) const {
  if (departed_ == kNever) return step >= counts_from_;
  const std::int64_t hops = static_cast<std::int64_t>(follower) - 1;
  if (step >= departed_ + hops) return step >= counts_from_ + hops;
  return step >= counted_from_ + (counted_from_ > burn_in_ ? hops : 0);
}

// Whether a manoeuvre affects the error directly; the burn-in behind it is not included.
bool TimeStatistics::departs(std::size_t follower, std::int64_t step) const {
  if (departed_ == kNever) return false;
  const std::int64_t hops = static_cast<std::int64_t>(follower) - 1;
  return step >= departed_ + hops && step < counts_from_ - burn_in_ + hops;
}

void TimeStatistics::add(const ReducedSignals& signals) {
  // With one realization the mean is the error itself.
  followers_.at(signals.follower - 1).early.emplace(signals.step, signals.nodes.front().front().mean);
  count_due(signals.follower);
}

void TimeStatistics::count_due(std::size_t index) {
  Follower& follower = followers_[index - 1];
  const std::int64_t hops = static_cast<std::int64_t>(index) - 1;
  for (auto next = follower.early.begin(); next != follower.early.end() && next->first == follower.next_step;
       next = follower.early.erase(next), ++follower.next_step) {
    if (leader_step_ != kNever && next->first > leader_step_ + hops) return;
    if (!counts(index, next->first)) {
      if (!measured(index - 1) && !departs(index, next->first)) follower.provisional.add(next->second);
      continue;
    }
    follower.moments.add(next->second);
    batches_[index - 1].add(next->second);
  }
}

bool TimeStatistics::empty() const {
  return std::all_of(followers_.begin(), followers_.end(), [](const Follower& of) { return of.next_step == 0; }) &&
         std::all_of(earlier_.begin(), earlier_.end(), [](const Moments& moments) { return moments.count == 0; });
}

std::int64_t TimeStatistics::counted_from() const {
  const std::int64_t hops = departed_ == kNever ? 0 : static_cast<std::int64_t>(followers_.size()) - 1;
  return counts_from_ + hops;
}

std::vector<Moments> TimeStatistics::moments() const {
  std::vector<Moments> all;
  for (std::size_t i = 0; i < followers_.size(); ++i) all.push_back(merge(earlier_[i], followers_[i].moments));
  return all;
}

std::vector<Moments> TimeStatistics::provisional() const {
  std::vector<Moments> all(followers_.size());
  bool any = false;
  for (std::size_t i = 0; i < followers_.size(); ++i) {
    if (measured(i)) continue;
    all[i] = followers_[i].provisional.moments();
    any = any || all[i].count > 0;
  }
  return any ? all : std::vector<Moments>();
}

std::vector<IndependentShare> TimeStatistics::shares() const {
  std::vector<IndependentShare> all;
  for (const BatchMeans& batches : batches_) all.push_back(batches.share());
  return all;
}

}  // namespace platoon
