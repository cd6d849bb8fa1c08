#include "stochastic_platoon/run/scaling/shard_run.hpp"

#include <locale>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/simulation/ensemble_run.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/clock.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/retried_write.hpp"
#include "stochastic_platoon/run/results/identity_differences.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"

namespace platoon {

namespace {

void require_same_shard(const Checkpoint& found, const ShardRun& run) {
  const std::string& output = run.configuration.run.output;
  if (found.shard.is_null())
    throw ConfigurationError(
        {"output: " + output + ": holds a run of " + extent_of(found) + " and no shard: must be another folder"});
  const std::string differing = identity_differences(found.identity, run.identity());
  if (!differing.empty())
    throw ConfigurationError({"output: " + output + ": holds a shard of another run: " + differing});
  const ShardRun there = shard_run_of(found.shard);
  if (there.shard.index == run.shard.index && there.shard.of == run.shard.of && there.samples() == run.samples())
    return;
  throw ConfigurationError({"output: " + output + ": holds " + name_of(there.shard) + " of " +
                            std::to_string(there.samples()) + " " + there.unit() + ", and this is " +
                            name_of(run.shard) + " of " + std::to_string(run.samples()) + ": must be another folder"});
}

// The realizations of the shard in the folder; none if the folder is empty, or its content is damaged.
std::optional<Checkpoint> held(const ShardRun& run, const ShardSettings& settings) {
  const std::string& output = run.configuration.run.output;
  std::optional<Checkpoint> found;
  try {
    found = read_checkpoint(output);
  } catch (const DamagedCheckpoint& error) {
    require_no_results(output);
    settings.warn(std::string(error.what()) + ": the shard begins anew");
    return std::nullopt;
  } catch (const std::runtime_error& error) {
    throw ConfigurationError({std::string("output: ") + error.what()});
  }
  if (!found) {
    require_no_results(output);
    return std::nullopt;
  }
  if (!found->damage.empty()) settings.warn(found->damage + ": the one before it is used");
  require_same_shard(*found, run);
  return found;
}

}  // namespace

Shard parse_shard(const std::string& text, std::uint64_t realizations) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  std::int64_t index = -1, of = 0;
  char slash = 0;
  if (stream >> index >> slash >> of && slash == '/' && stream.eof() && index >= 0 && of > index) {
    const Shard shard{static_cast<std::uint64_t>(index), static_cast<std::uint64_t>(of)};
    if (shard.of <= realizations && shard.of <= kMostShards) return shard;
  }
  const std::string of_run =
      realizations == kMostShards ? "" : "the " + std::to_string(realizations) + " realizations and ";
  throw ConfigurationError({"shard: " + shortened(text) + ": must be I/N, I from 0 to N - 1, N at most " + of_run +
                            std::to_string(kMostShards)});
}

std::string name_of(const Shard& shard) {
  return "shard " + std::to_string(shard.index) + "/" + std::to_string(shard.of);
}

std::string ShardRun::unit() const {
  return rare.is_object() && rare.value("method", "") == "split" ? "repetitions" : "realizations";
}

std::uint64_t ShardRun::samples() const {
  return rare.is_null() ? configuration.run.realizations : rare.at("samples").get<std::uint64_t>();
}

nlohmann::json ShardRun::identity() const {
  nlohmann::json identity = statistics_identity(configuration);
  if (!rare.is_null()) identity["rare"] = rare;
  return identity;
}

nlohmann::json to_json(const ShardRun& run) {
  nlohmann::json record = {
      {"index", run.shard.index}, {"of", run.shard.of}, {"configuration", to_json(run.configuration)}};
  if (!run.rare.is_null()) record["rare"] = run.rare;
  return record;
}

ShardRun shard_run_of(const nlohmann::json& record) {
  try {
    ShardRun run{recorded_configuration(record.at("configuration")),
                 {record.at("index").get<std::uint64_t>(), record.at("of").get<std::uint64_t>()},
                 record.value("rare", nlohmann::json())};
    if (run.configuration.version != kVersion)
      throw std::invalid_argument("version: " + run.configuration.version + ": must be " + kVersion);
    run.configuration.run.hosting = Hosting::monte_carlo;
    run.range();  // throws if there is no such shard
    return run;
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string("its shard cannot be read: ") + error.what());
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(std::string("its shard cannot be read: ") + error.what());
  }
}

void StopRequest::obey(EnsembleRun& run) {
  if (!settings_.stop()) return;
  run.stop();
  if (!since_) since_ = now();
  if (now() - *since_ > settings_.stop_seconds) run.abandon();
}

Ensemble ensemble_of(const RunOptions& run) {
  return {run.seed, run.followers, run.steps, run.batch, run.signals};
}

ShardResult compute_shard(const ShardRun& run, const ShardSettings& settings) {
  return compute_shard(run, settings, batch_work(run.configuration.model, ensemble_of(run.configuration.run)));
}

ShardResult compute_shard(const ShardRun& run, const ShardSettings& settings, const BatchWork& computation) {
  const RunOptions& options = run.configuration.run;
  const double began = now();
  const std::optional<Checkpoint> found = held(run, settings);
  const double earlier_seconds = found ? found->tally.wall_seconds : 0.0;
  EnsembleRun work(computation, run.range(), found ? found->totals : computation.none, settings.checkpoint_seconds);
  const std::uint64_t held_before = work.done();
  if (work.is_complete()) return {*found, 0};
  if (!slow_noise().empty()) settings.warn(slow_noise());
  std::uint64_t saved = found ? found->totals.count() : 0;
  const auto checkpoint_of = [&](EnsembleTotals totals) {
    const Tally tally{positions_expected(options, totals.count()), 1, earlier_seconds + now() - began, 0};
    return Checkpoint{run.identity(), options.launch_id, tally, std::move(totals), {}, {}, to_json(run)};
  };
  const auto write = [&](const EnsembleTotals& totals) {
    // Skip a checkpoint without new realizations: it would count as progress.
    if (totals.count() == saved) return;
    write_checkpoint(options.output, checkpoint_of(totals));
    saved = totals.count();
  };
  double written = began;
  RetriedWrite retried(
      [&](const std::string& error) { settings.warn(error + ": the run continues without a checkpoint"); });
  StopRequest stop(settings);
  complete(work, settings.threads, [&] {
    settings.progress(work.done());
    stop.obey(work);
    const double present = now();
    if (work.all_begun() || present - written < settings.checkpoint_seconds || !retried.is_due(present)) return;
    if (retried(present, [&] { work.read(write); })) written = now();
  });
  ShardResult result{checkpoint_of(work.release()), work.done() - held_before};
  try {
    if (result.computed > 0) write_checkpoint(options.output, result.checkpoint);
  } catch (const std::system_error& error) {
    result.unsaved = error.what();
  }
  return result;
}

}  // namespace platoon
