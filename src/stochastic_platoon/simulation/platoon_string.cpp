#include "stochastic_platoon/simulation/platoon_string.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>

#include "stochastic_platoon/statistics/ensemble_statistics.hpp"

namespace platoon {

PlatoonString::PlatoonString(const PlatoonModel& model, std::uint64_t seed, std::size_t followers)
    : leader_(model), predecessor_(kStepsAtOnce + 1), own_(kStepsAtOnce + 1) {
  for (std::uint32_t i = 1; i <= followers; ++i) {
    followers_.emplace_back(model, seed, i);
    links_.emplace_back(model, seed, i);
    error_.push_back(tracking_error(model, i));
  }
}

void PlatoonString::run(std::uint64_t first, std::size_t count, std::int64_t steps, const ErrorSink& sink) {
  received_.resize(count);
  errors_.resize(count);
  for (AlignedValues& positions : predecessor_) positions.resize(count);
  for (AlignedValues& positions : own_) positions.resize(count);
  latest_.resize(followers_.size() + 1);
  latest_[0].assign(count, leader_.start());
  for (std::size_t i = 1; i < latest_.size(); ++i) followers_[i - 1].start(first, count, latest_[i]);
  for (std::int64_t from = 0; from < steps; from += kStepsAtOnce) {
    const auto here = static_cast<std::size_t>(std::min(kStepsAtOnce, steps - from));
    own_[0].assign(latest_[0].begin(), latest_[0].end());
    for (std::size_t j = 1; j <= here; ++j) own_[j].assign(count, leader_.step());
    latest_[0].assign(own_[here].begin(), own_[here].end());
    for (std::size_t i = 1; i < latest_.size(); ++i) {
      own_.swap(predecessor_);
      own_[0].assign(latest_[i].begin(), latest_[i].end());
      for (std::size_t j = 1; j <= here; ++j) {
        const std::int64_t k = from + static_cast<std::int64_t>(j) - 1;
        links_[i - 1].transmit(k - 1, first, predecessor_[j - 1].data(), count, received_.data());
        followers_[i - 1].step(received_.data(), own_[j].data());
        error_[i - 1](predecessor_[j].data(), own_[j].data(), own_[j - 1].data(), count, errors_.data());
        sink(i, k, errors_);
      }
      latest_[i].assign(own_[here].begin(), own_[here].end());
    }
  }
}

namespace {

class BatchQueue {
public:
  explicit BatchQueue(const Ensemble& ensemble) : ensemble_(ensemble) {}
  bool take(std::uint64_t* first, std::size_t* count) {
    *first = next_.fetch_add(ensemble_.batch);
    if (*first >= ensemble_.realizations) return false;
    *count = static_cast<std::size_t>(std::min(ensemble_.batch, ensemble_.realizations - *first));
    return true;
  }
  void finish(std::size_t count) { done_ += count; }
  std::uint64_t done() const { return done_; }

private:
  Ensemble ensemble_;
  std::atomic<std::uint64_t> next_{0};
  std::atomic<std::uint64_t> done_{0};
};

MomentTable work(const PlatoonModel& model, const Ensemble& ensemble, BatchQueue& queue) {
  PlatoonString string(model, ensemble.seed, ensemble.followers);
  EnsembleStatistics statistics(ensemble.followers, ensemble.steps,
                                has_normal_errors(model) ? KeptMoments::two : KeptMoments::four);
  std::uint64_t first;
  std::size_t count;
  while (queue.take(&first, &count)) {
    BatchMoments& batch = statistics.open(first, count);
    string.run(first, count, ensemble.steps,
               [&](std::size_t follower, std::int64_t step, const auto& errors) {
                 batch.set(cell(follower, step, ensemble.steps), errors.data());
               });
    statistics.commit(first);
    queue.finish(count);
  }
  return statistics.committed();
}

}  // namespace

MomentTable monte_carlo(const PlatoonModel& model, const Ensemble& ensemble, unsigned threads,
                        const std::function<void(std::uint64_t)>& progress) {
  BatchQueue queue(ensemble);
  std::vector<std::future<MomentTable>> workers;
  for (unsigned t = 0; t < std::max(threads, 1u); ++t) {
    workers.push_back(std::async(std::launch::async, [&] { return work(model, ensemble, queue); }));
  }
  MomentTable table(ensemble.followers * static_cast<std::size_t>(ensemble.steps));
  for (auto& worker : workers) {
    while (worker.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready)
      progress(queue.done());
    table.merge(worker.get());
  }
  progress(queue.done());
  return table;
}

}  // namespace platoon
