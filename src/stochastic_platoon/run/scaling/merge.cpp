#include "stochastic_platoon/run/scaling/merge.hpp"

#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/identity_differences.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"

namespace platoon {

namespace {

// Reads the folders one by one and keeps only the place of each shard.
class Inventory {
public:
  explicit Inventory(const std::vector<std::string>& folders) {
    for (const std::string& folder : folders) add(folder);
  }

  // Throws IncompleteRun unless all shards are there and no folder has a problem.
  void require_all() const {
    std::vector<std::uint64_t> missing;
    const std::uint64_t of = first_ ? first_->shard.of : 0;
    for (std::uint64_t i = 0; i < of; ++i) {
      if (places_.count(i) == 0) missing.push_back(i);
    }
    if (!missing.empty() || !problems_.empty()) throw IncompleteRun(missing, of, problems_);
  }

  const ShardRun& first() const { return *first_; }

  /// Folder of each shard, by its index.
  const std::map<std::uint64_t, std::string>& places() const { return places_; }

private:
  void add(const std::string& folder) {
    try {
      const std::optional<Checkpoint> found = read_checkpoint(folder);
      if (!found) return reject(folder, "holds no shard: must be the output of monte_carlo --shard or rare --shard");
      if (found->shard.is_null()) return reject(folder, "holds a run of " + extent_of(*found) + " and no shard");
      take(folder, *found);
    } catch (const ConfigurationError& error) {
      reject(folder, error.problems().front());
    } catch (const std::runtime_error& error) {
      problems_.emplace_back(error.what());
    }
  }

  void reject(const std::string& folder, const std::string& why) { problems_.push_back(folder + ": " + why); }

  void take(const std::string& folder, const Checkpoint& found) {
    const ShardRun run = shard_run_of(found.shard);
    if (!first_) {
      // With the arithmetic of another machine the same model may have another closed loop.
      const std::string own = identity_differences(found.identity, run.identity());
      if (!own.empty()) return reject(folder, "is of a run that this machine would compute otherwise: " + own);
      first_ = run;
      first_folder_ = folder;
      identity_ = found.identity;
    }
    const std::string differing = differences(found, run);
    if (!differing.empty()) return reject(folder, "belongs to another run than " + first_folder_ + ": " + differing);
    const RealizationRange range = run.range();
    std::uint64_t gaps = 0;
    for (const RealizationRange& gap : found.totals.moments.missing(range)) gaps += gap.size();
    if (gaps > 0 || found.totals.count() != range.size()) {
      return reject(folder, name_of(run.shard) + " is not complete: " + std::to_string(range.size() - gaps) + " of " +
                                std::to_string(range.size()) + " realizations" +
                                (found.damage.empty() ? "" : " (" + found.damage + ")"));
    }
    const auto place = places_.emplace(run.shard.index, folder);
    if (!place.second)
      reject(folder, "holds " + name_of(run.shard) + ", as does " + place.first->second + ": must be given once");
  }

  std::string differences(const Checkpoint& found, const ShardRun& run) const {
    const auto extent = [](const ShardRun& of) {
      return nlohmann::json{{"shards", of.shard.of}, {"realizations", of.samples()}};
    };
    const std::string identities = identity_differences(identity_, found.identity);
    const std::string extents = identity_differences(extent(*first_), extent(run));
    return identities + (identities.empty() || extents.empty() ? "" : ", ") + extents;
  }

  std::optional<ShardRun> first_;
  std::string first_folder_;
  nlohmann::json identity_;
  std::map<std::uint64_t, std::string> places_;
  std::vector<std::string> problems_;
};

std::vector<std::string> with_missing(const std::vector<std::uint64_t>& missing, std::uint64_t of,
                                      std::vector<std::string> problems) {
  if (!missing.empty()) {
    const std::string indices = array_indices(missing);
    problems.insert(problems.begin(), "shards " + indices + " of " + std::to_string(of) +
                                          ": missing: must be computed (sbatch --array=" + indices + ")");
  }
  return abbreviated(problems);
}

}  // namespace

IncompleteRun::IncompleteRun(const std::vector<std::uint64_t>& missing, std::uint64_t of,
                             std::vector<std::string> others)
    : ConfigurationError(with_missing(missing, of, others)), missing_(missing), of_(of), others_(std::move(others)) {}

std::vector<std::uint64_t> IncompleteRun::missing(std::uint64_t of) const {
  if (of_ > 0) return missing_;
  std::vector<std::uint64_t> all(of);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

std::string array_indices(const std::vector<std::uint64_t>& ascending) {
  std::string text;
  for (std::size_t begin = 0, end; begin < ascending.size(); begin = end) {
    for (end = begin + 1; end < ascending.size() && ascending[end] == ascending[end - 1] + 1;) ++end;
    text += (text.empty() ? "" : ",") + std::to_string(ascending[begin]);
    if (end > begin + 1) text += "-" + std::to_string(ascending[end - 1]);
  }
  return text;
}

MergedShards merge_shards(const std::vector<std::string>& folders) {
  const Inventory inventory(folders);
  inventory.require_all();
  const ShardRun& run = inventory.first();
  MergedShards merged{run, {}, {positions_expected(run.configuration.run, run.samples()), 1, 0.0, 0}};
  // In ascending order, so that the shards merged so far occupy few blocks.
  for (const auto& place : inventory.places()) {
    std::optional<Checkpoint> shard = read_checkpoint(place.second);
    if (!shard) throw std::runtime_error(place.second + ": is gone");
    if (merged.totals.count() == 0) {
      merged.totals = std::move(shard->totals);
    } else {
      merged.totals.merge(shard->totals);
    }
    merged.tally.wall_seconds += shard->tally.wall_seconds;
  }
  if (merged.totals.count() != run.samples() || !merged.totals.moments.missing({0, run.samples()}).empty())
    throw std::runtime_error("a shard has changed while it was read");
  return merged;
}

MergedRun merge(const std::vector<std::string>& folders) {
  const MergedShards merged = merge_shards(folders);
  if (!merged.run.rare.is_null())
    throw ConfigurationError({"shards of rare: must be joined by the program of that name: rare DIR... --output DIR"});
  return {merged.run.configuration, result_of(merged.run.configuration, merged.totals, merged.tally)};
}

}  // namespace platoon
