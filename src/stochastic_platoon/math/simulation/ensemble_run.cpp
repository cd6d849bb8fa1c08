#include "stochastic_platoon/math/simulation/ensemble_run.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <memory>
#include <utility>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/simulation/platoon_string.hpp"

namespace platoon {

namespace {

// Limit of the cells in a thread's own blocks. Their siblings may belong to another thread, and only handed-over blocks
// are joined with these.
constexpr std::size_t kMostOwnCells = 1u << 21;  // 32 MB

SignalCells cells_of(const PlatoonModel& model, const Ensemble& ensemble) {
  return signal_cells(model, ensemble.followers, ensemble.steps, ensemble.signals);
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

BatchWork batch_work(const PlatoonModel& model, const Ensemble& ensemble) {
  const auto computation = [model, ensemble]() -> BatchWork::Computation {
    auto string =
        std::make_shared<PlatoonString>(model, ensemble.seed, ensemble.followers,
                                        steps_before(signals_of(model, ensemble.signals, 1)), ensemble.signals);
    return [ensemble, string, cells = cells_of(model, ensemble),
            signals = signals_of_all(model, ensemble.signals, ensemble.followers)](
               const RealizationRange& batch, const std::function<void()>& check, EnsembleTotals& own) {
      BatchTotals totals(batch.first, batch.size(), cells);
      string->run(batch.first, batch.size(), ensemble.steps,
                  [&](std::size_t follower, std::int64_t step, const SignalPositions& positions) {
                    check();
                    totals.add(follower, step, signals[follower - 1], positions);
                  });
      totals.finish();
      own.add(std::move(totals));
    };
  };
  return {EnsembleTotals(cells_of(model, ensemble)), ensemble.batch, computation};
}

EnsembleRun::EnsembleRun(BatchWork work, const RealizationRange& range, EnsembleTotals earlier,
                         double hand_over_seconds)
    : work_(std::move(work)),
      hand_over_seconds_(hand_over_seconds),
      waiting_(earlier.moments.missing(range)),
      totals_(std::move(earlier)) {
  for (const RealizationRange& gap : waiting_) outstanding_ += gap.size();
  std::reverse(waiting_.begin(), waiting_.end());
  done_ = range.size() - outstanding_;
  all_begun_ = waiting_.empty();
}

EnsembleRun::EnsembleRun(const PlatoonModel& model, const Ensemble& ensemble, const RealizationRange& range,
                         EnsembleTotals earlier, double hand_over_seconds)
    : EnsembleRun(batch_work(model, ensemble), range, std::move(earlier), hand_over_seconds) {}

EnsembleRun::EnsembleRun(const PlatoonModel& model, const Ensemble& ensemble, const RealizationRange& range)
    : EnsembleRun(model, ensemble, range, EnsembleTotals(cells_of(model, ensemble))) {}

// Batches start at multiples of their size, regardless of the start of the range, so each has few blocks.
bool EnsembleRun::take(RealizationRange* batch) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (waiting_.empty()) return false;
  RealizationRange& next = waiting_.back();
  const std::uint64_t multiple = (next.first / work_.batch + 1) * work_.batch;
  *batch = {next.first, std::min(multiple, next.end)};
  next.first = batch->end;
  if (next.size() == 0) waiting_.pop_back();
  all_begun_ = waiting_.empty();
  return true;
}

bool EnsembleRun::hand_over(EnsembleTotals& own) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::uint64_t count = own.count();
  totals_.merge(own);
  own = work_.none;
  outstanding_ -= count;
  return outstanding_ == 0 && count > 0;
}

bool EnsembleRun::work() {
  RealizationRange batch;
  if (!take(&batch)) return false;
  const BatchWork::Computation compute = work_.computation();
  EnsembleTotals own = work_.none;
  double handed_over = now();
  const std::function<void()> check = [this] {
    if (abandoned_.load(std::memory_order_relaxed)) throw Interrupted();
  };
  do {
    try {
      compute(batch, check, own);
    } catch (const Interrupted&) {
      return hand_over(own);
    }
    done_ += batch.size();
    const bool is_full = own.moments.blocks().size() * own.moments.cells() >= kMostOwnCells;
    if (is_full || now() - handed_over >= hand_over_seconds_) {
      if (hand_over(own)) return true;
      handed_over = now();
    }
  } while (take(&batch));
  return hand_over(own);
}

void EnsembleRun::stop() {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.clear();
  all_begun_ = true;
}

void EnsembleRun::abandon() {
  stop();
  abandoned_ = true;
}

bool EnsembleRun::is_complete() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return outstanding_ == 0;
}

void EnsembleRun::read(const std::function<void(const EnsembleTotals&)>& reader) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  reader(totals_);
}

EnsembleTotals EnsembleRun::release() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::move(totals_);
}

void complete(EnsembleRun& run, unsigned threads, const std::function<void()>& tick) {
  std::vector<std::future<bool>> workers;
  for (unsigned t = 0; t < std::max(threads, 1u); ++t)
    workers.push_back(std::async(std::launch::async, [&run] { return run.work(); }));
  for (auto& worker : workers) {
    while (worker.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready) {
      try {
        tick();
      } catch (...) {
        run.abandon();  // the other workers end before their futures do
        throw;
      }
    }
    worker.get();
  }
  tick();
}

}  // namespace platoon
