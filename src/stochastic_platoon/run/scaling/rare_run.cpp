#include "stochastic_platoon/run/scaling/rare_run.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/rare/conditioned_gaps.hpp"
#include "stochastic_platoon/math/rare/splitting.hpp"
#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"

namespace platoon {

namespace {

constexpr char kAuto[] = "auto", kCondition[] = "condition", kSplit[] = "split";
constexpr char kDistance[] = "standstill_distance", kHeadway[] = "time_headway";

}  // namespace

ShardRun RareRun::shard(const Shard& shard) const {
  return {configuration,
          shard,
          {{"below", options.below},
           {"burn_in", configuration.run.burn_in},
           {"method", options.method},
           {"realizations", configuration.run.realizations},
           {"samples", samples()}}};
}

BatchWork RareRun::work() const {
  BatchWork work = estimator->work();
  work.computation = [of = estimator, computation = std::move(work.computation)] { return computation(); };
  return work;
}

RareOptions rare_options(const std::map<std::string, std::string>& given) {
  ProblemCollector problems;
  const auto read = [&](const std::string& name, const Allowed& allowed, double none) {
    const auto found = given.find(name);
    if (found == given.end()) return none;
    return problems.result_of([&] { return number_of(name, found->second, allowed); }).value_or(none);
  };
  RareOptions options{read("below", kAnyFinite, 0.0), kAuto, {}};
  if (const double speed = read("speed", kPositive, 0.0); speed > 0.0) options.speed = speed;
  if (const auto method = given.find("method"); method != given.end()) options.method = method->second;
  if (options.method != kAuto && options.method != kCondition && options.method != kSplit)
    problems.add("method: " + shortened(options.method) + ": must be auto, condition or split");
  problems.require_none();
  return options;
}

void require_applicable(const Configuration& configuration, const RareOptions& options) {
  const RunOptions& run = configuration.run;
  ProblemCollector problems;
  if (options.method == kCondition && !has_normal_errors(configuration.model))
    problems.add(std::string("method: condition: the gaps are not normal, because ") +
                 (has_limits(configuration.model) ? "a vehicle has limits" : "a link loses or quantises") +
                 ": must be split or auto");
  if (run.averaging() == Averaging::over_time) problems.add("steps: 0: must be at least 1");
  if (run.averaging() != Averaging::over_time && run.burn_in >= run.steps)
    problems.add(formatted("burn_in: %lld: must be below the %lld steps", static_cast<long long>(run.burn_in),
                           static_cast<long long>(run.steps)));
  if (!run.external.empty()) problems.add("external: given: must be absent: only the model is simulated");
  problems.require_none();
}

RareRun rare_run(const Configuration& configuration, RareOptions options, unsigned threads) {
  require_applicable(configuration, options);
  if (options.method == kAuto) options.method = has_normal_errors(configuration.model) ? kCondition : kSplit;
  const RunOptions& run = configuration.run;
  const RareEvent event{run.seed, run.followers, run.steps, options.below, run.burn_in};
  try {
    std::shared_ptr<const RareEstimator> estimator;
    if (options.method == kCondition) {
      estimator = std::make_shared<ConditionedGaps>(configuration.model, event);
    } else {
      estimator = std::make_shared<Splitting>(configuration.model, event, run.realizations, threads);
    }
    return {configuration, options, estimator};
  } catch (const std::invalid_argument& error) {
    throw ConfigurationError({error.what()});
  }
}

RareRun rare_run(const ShardRun& shard, unsigned threads) {
  return rare_run(shard.configuration,
                  {shard.rare.at("below").get<double>(), shard.rare.at("method").get<std::string>()}, threads);
}

RareResult rare_result(const RareRun& run, const EnsembleTotals& totals) {
  RareResult result{totals.count()};
  if (result.samples == 0) return result;
  result.rows = rare_rows(run.configuration, *run.estimator, totals.moments.totals());
  nlohmann::json details = nlohmann::json::object();
  for (std::size_t row = 0; row < result.rows.size(); ++row) {
    if (const auto levels = run.estimator->levels(row); !levels.empty())
      details["levels"][result.rows[row].vehicle] = levels;
    if (!result.rows[row].problem.empty()) details["problems"][result.rows[row].vehicle] = result.rows[row].problem;
  }
  result.files = {{"rare.csv", rare_csv(result.rows)},
                  {"rare.json", rare_json(run.configuration, run.options, result.samples, result.rows, details)}};
  result.report = rare_report(run.configuration, run.options, result.samples, result.rows);
  if (details.contains("problems")) {
    for (const auto& [vehicle, problem] : details["problems"].items())
      result.report += problem.get<std::string>() + "\n";
  }
  return result;
}

std::optional<RareRequirement> rare_requirement(const std::map<std::string, std::string>& given) {
  const auto text = [&](const char* name, const char* otherwise) {
    const auto found = given.find(name);
    return found == given.end() ? std::string(otherwise) : found->second;
  };
  const std::string per = text("per", "run"), over = text("over", kDistance);
  ProblemCollector problems;
  if (given.count("required") == 0) {
    for (const char* name : {"per", "over"}) {
      if (given.count(name) > 0) problems.add(std::string(name) + ": given: must be with required");
    }
    problems.require_none();
    return std::nullopt;
  }
  if (per != "run" && per != "hour") problems.add("per: " + shortened(per) + ": must be run or hour");
  if (over != kDistance && over != kHeadway)
    problems.add("over: " + shortened(over) + ": must be " + kDistance + " or " + kHeadway);
  const Allowed allowed{"above 0 and below 1", kAboveZero, 1.0, 1.0};
  const auto probability = problems.result_of([&] { return number_of("required", text("required", ""), allowed); });
  problems.require_none();
  return RareRequirement{*probability, per == "hour", over};
}

double required_value(const RareRequirement& requirement, double start,
                      const std::function<RareRun(double value)>& estimation, const ShardSettings& settings,
                      const std::function<void(double value, double figure)>& tried) {
  std::string problem;
  // ln of the figure over ln of the required one; above 0 where the event is no rare one.
  const auto excess = [&](double value) {
    std::optional<RareRun> run;
    try {
      run = estimation(value);
    } catch (const ConfigurationError& error) {
      problem = std::string("; there: ") + error.what();
      return 1e3;
    }
    run->configuration.run.output.clear();
    const RareResult result = compute_rare(*run, settings);
    if (settings.stop()) throw Interrupted();
    // The probability of any follower is at least that of each; all estimates have errors of their own.
    double most = -std::numeric_limits<double>::infinity();
    for (const RareRow& of : result.rows) {
      const double upper = requirement.per_hour ? log_per_hour(run->configuration, of.log_upper) : of.log_upper;
      if (!of.problem.empty() && !(upper <= std::log(requirement.probability)))
        problem = ", or realizations more; there: " + of.problem;
      most = std::isnan(upper) ? 1e3 : std::max(most, upper);
    }
    tried(value, std::exp(most));
    return most - std::log(requirement.probability);
  };
  constexpr double kFactor = 1.5, kMost = 100.0;
  double low = start, high = start;
  const bool grows = excess(start) > 0.0;
  while (grows && excess(high *= kFactor) > 0.0) {
    low = high;
    if (high < kMost * start) continue;
    throw ConfigurationError({formatted("required: %g: not reached by %s from %g to %g: must be another value",
                                        requirement.probability, requirement.over.c_str(), start, high) +
                              problem});
  }
  while (!grows && excess(low /= kFactor) <= 0.0) {
    high = low;
    if (low > start / kMost) continue;
    throw ConfigurationError({formatted("required: %g: satisfied by every %s from %g to %g: must be smaller",
                                        requirement.probability, requirement.over.c_str(), low, start)});
  }
  while (high - low > 1e-3 * high) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0.0 ? low : high) = middle;
  }
  return high;
}

void require_no_rare_results(const std::string& output) {
  if (!may_exist(output + "/rare.csv")) return;
  throw ConfigurationError(
      {"output: " + output + ": holds a rare.csv already, which is never overwritten: must be another folder"});
}

void require_an_estimate(const RareRun& run) {
  for (std::size_t row = 0; row <= run.configuration.run.followers; ++row) {
    if (run.estimator->problem(row).empty() || !run.estimator->log_scales(row).empty()) return;
  }
  throw ConfigurationError({run.estimator->problem(0)});
}

std::size_t rare_row(const std::string& vehicle, std::size_t followers) {
  if (vehicle.empty() || vehicle == "any") return followers;
  return static_cast<std::size_t>(integer_of("vehicle", vehicle, 1, static_cast<std::int64_t>(followers))) - 1;
}

RareReplay rare_replay(const RareRun& run, const std::string& vehicle, const std::string& only) {
  const std::size_t row = rare_row(vehicle, run.configuration.run.followers);
  std::optional<std::uint64_t> sample;
  if (!only.empty())
    sample = static_cast<std::uint64_t>(integer_of("only", only, 0, static_cast<std::int64_t>(run.samples()) - 1));
  RareReplay replay{run.options.method == kCondition ? sample.value_or(0) : 0, run.estimator->replay(row, sample)};
  if (replay.changes == nullptr && run.options.method == kCondition)
    throw ConfigurationError(
        {formatted("below: %g: of probability 0 here: must be larger, or another vehicle", run.options.below)});
  if (replay.changes == nullptr)
    throw ConfigurationError({"only: " + (only.empty() ? "(empty)" : only) +
                              ": no path of this repetition reaches the last level: must be another one"});
  return replay;
}

void write_rare(const std::string& output, const RareResult& result) {
  require_no_rare_results(output);
  // Results without rare.csv are incomplete, and the same command writes them.
  for (const char* name : {"rare.json", "rare.csv"}) write_atomically(output + "/" + name, result.files.at(name));
}

RareResult compute_rare(RareRun run, const ShardSettings& settings) {
  RunOptions& options = run.configuration.run;
  const std::string output = options.output;
  if (output.empty()) {
    const BatchWork computation = run.work();
    EnsembleRun work(computation, {0, run.samples()}, computation.none);
    StopRequest stop(settings);
    complete(work, settings.threads, [&] {
      settings.progress(work.done());
      stop.obey(work);
    });
    return rare_result(run, work.release());
  }
  // A restarted estimation keeps its name, so that it takes over its folder and its lock.
  options.launch_id = "rare";
  const std::unique_ptr<FolderLock> lock = lock_output(options);
  require_no_rare_results(output);
  const ShardResult computed = compute_shard(run.shard({0, 1}), settings, run.work());
  if (!computed.unsaved.empty()) throw std::runtime_error(computed.unsaved);
  options.launch_id.clear();
  RareResult result = rare_result(run, computed.checkpoint.totals);
  if (result.samples < run.samples()) return result;  // its checkpoint continues it
  write_rare(output, result);
  remove_checkpoints(output);
  return result;
}

}  // namespace platoon
