#include "stochastic_platoon/run/scaling/sweep_run.hpp"

#include <chrono>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <utility>

#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/math/simulation/ensemble_run.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/identity_differences.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/scaling/merge.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"
#include "stochastic_platoon/run/scaling/sweep_results.hpp"

namespace platoon {

namespace {

struct ActivePoint {
  ActivePoint(std::uint64_t at, std::string named, Configuration of)
      : point(at),
        name(std::move(named)),
        configuration(std::move(of)),
        run(configuration.model, ensemble_of(configuration.run), {0, configuration.run.realizations}) {}

  const std::uint64_t point;
  const std::string name;
  const Configuration configuration;
  EnsembleRun run;
};

struct FinishedPoint {
  std::uint64_t point;
  std::string content;
};

// Distributes points to threads: one thread begins the next point while another still computes the last batch of the
// previous one.
class PointQueue {
public:
  PointQueue(const Sweep& sweep, const std::vector<std::uint64_t>& points) : sweep_(sweep), points_(points) {}

  void work() {
    while (const std::shared_ptr<ActivePoint> active = current()) {
      if (active->run.work()) finish(*active);
    }
  }

  std::deque<FinishedPoint> finished() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(finished_, {});
  }

  /// Completed realizations of all points.
  std::uint64_t done() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::uint64_t sum = finished_realizations_;
    for (const auto& active : active_) sum += active->run.done();
    return sum;
  }

  /// Name of the point begun last.
  std::string name() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return active_.empty() ? "" : active_.back()->name;
  }

  /// Begins no further point.
  void stop() {
    const std::lock_guard<std::mutex> lock(mutex_);
    next_ = points_.size();
  }

private:
  // Under the lock, as YAML nodes are not thread-safe.
  std::shared_ptr<ActivePoint> current() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!active_.empty() && !active_.back()->run.all_begun()) return active_.back();
    if (next_ == points_.size()) return nullptr;
    const std::uint64_t point = points_[next_++];
    active_.push_back(std::make_shared<ActivePoint>(point, sweep_.name_of(point), sweep_.configuration(point)));
    return active_.back();
  }

  void finish(ActivePoint& active) {
    const RunResult result = result_of(active.configuration, active.run.release());
    const Prediction prediction = predict(active.configuration);
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::string rows = sweep_rows(sweep_, active.point, active.configuration, prediction, result);
    finished_.push_back({active.point, point_content(sweep_, active.point, rows)});
    finished_realizations_ += result.realizations;
    for (auto it = active_.begin(); it != active_.end(); ++it) {
      if (it->get() != &active) continue;
      active_.erase(it);
      break;
    }
  }

  const Sweep& sweep_;
  const std::vector<std::uint64_t>& points_;
  mutable std::mutex mutex_;
  std::size_t next_ = 0;
  std::deque<std::shared_ptr<ActivePoint>> active_;  ///< the latest begun is at the back
  std::deque<FinishedPoint> finished_;               ///< not written yet
  std::uint64_t finished_realizations_ = 0;
};

}  // namespace

std::vector<std::uint64_t> missing_points(const Sweep& sweep, const SweepSettings& settings) {
  require_own_table(settings.output, "sweep");
  std::vector<std::uint64_t> missing;
  for (std::uint64_t point = 0; point < sweep.points(); ++point) {
    std::string damage;
    if (!read_point(sweep, settings.output, point, &damage)) missing.push_back(point);
    if (!damage.empty()) settings.warn(damage + ": it is computed again");
  }
  return missing;
}

void compute_points(const Sweep& sweep, const std::vector<std::uint64_t>& points, const SweepSettings& settings) {
  if (points.empty()) return;
  if (!slow_noise().empty()) settings.warn(slow_noise());
  PointQueue queue(sweep, points);
  std::vector<std::future<void>> workers;
  for (unsigned t = 0; t < settings.threads; ++t)
    workers.push_back(std::async(std::launch::async, [&queue] { queue.work(); }));
  const auto write = [&] {
    for (const FinishedPoint& finished : queue.finished())
      write_atomically(point_file(settings.output, finished.point), finished.content);
    settings.progress(queue.done(), queue.name());
  };
  try {
    for (auto& worker : workers) {
      while (worker.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready) write();
      worker.get();
    }
    write();
  } catch (...) {
    queue.stop();
    throw;  // the futures wait for their threads
  }
}

void merge_points(const Sweep& sweep, const std::vector<std::uint64_t>& points, const SweepSettings& settings) {
  std::vector<std::uint64_t> tasks;
  std::vector<std::string> problems;
  for (const std::uint64_t point : points) {
    std::vector<std::string> folders;
    for (std::uint64_t i = 0; i < sweep.shards; ++i) {
      const std::string folder = shard_folder(settings.output, point, i);
      if (may_exist(folder)) folders.push_back(folder);
    }
    if (folders.empty()) {
      for (std::uint64_t i = 0; i < sweep.shards; ++i) tasks.push_back(point * sweep.shards + i);
      continue;
    }
    const Configuration configuration = sweep.configuration(point);
    try {
      const MergedRun merged = merge(folders);
      const auto identity_of = [](const Configuration& of) {
        nlohmann::json identity = statistics_identity(of);
        identity["realizations"] = of.run.realizations;
        return identity;
      };
      const std::string differing = identity_differences(identity_of(merged.configuration), identity_of(configuration));
      if (!differing.empty()) {
        throw ConfigurationError({folders.front() + ": is of another sweep than point " + std::to_string(point) + " (" +
                                  sweep.name_of(point) + ") of this one: " + differing});
      }
      const std::string rows = sweep_rows(sweep, point, configuration, predict(configuration), merged.result);
      write_atomically(point_file(settings.output, point), point_content(sweep, point, rows));
    } catch (const IncompleteRun& error) {
      for (const std::uint64_t shard : error.missing(sweep.shards)) tasks.push_back(point * sweep.shards + shard);
      problems.insert(problems.end(), error.others().begin(), error.others().end());
    } catch (const ConfigurationError& error) {
      problems.push_back(error.problems().front());
    }
  }
  if (!tasks.empty()) {
    const std::string indices = array_indices(tasks);
    problems.insert(problems.begin(),
                    "tasks " + indices + ": missing: must be computed (sbatch --array=" + indices + ")");
  }
  if (!problems.empty()) throw ConfigurationError(abbreviated(problems));
}

}  // namespace platoon
