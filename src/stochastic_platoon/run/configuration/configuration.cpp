#include "stochastic_platoon/run/configuration/configuration.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/settling_time.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"
#include "stochastic_platoon/run/io/digest.hpp"

namespace platoon {

namespace {

void require_version(Section& document) {
  if (!document.is_mapping()) return;
  if (!document.has("version")) {
    document.reject("version", "missing", std::string(kVersion) + ", this program's (version 0.1.0 wrote none)");
    return;
  }
  const std::string version = document.text("version");
  if (version != kVersion) document.reject("version", version, std::string(kVersion) + ", this program's");
}

// Limit of followers^2 x steps for exact variances with losses: about a minute of computation.
constexpr double kMostLossResponses = 1e10;

bool has_independent_losses(const PlatoonModel& model) {
  return any_link(model, [](const LinkModel& link) { return link.loses() && link.loss->is_independent(); });
}

void require_feasible_theory(const PlatoonModel& model, const RunOptions& run, std::vector<std::string>& problems) {
  const double most =
      std::floor(std::sqrt(kMostLossResponses / static_cast<double>(std::max<std::int64_t>(run.steps, 1))));
  if (run.steps == 0 || static_cast<double>(run.followers) <= most || !has_independent_losses(model) ||
      !hears_predecessors_only(model))
    return;
  problems.push_back(formatted(
      "run/followers: %zu: must be at most %.0f with losses and %lld steps, as every link's losses act on every vehicle behind it (steps: 0 averages over time instead)",
      run.followers, most, static_cast<long long>(run.steps)));
}

constexpr double kChosenSeconds = 10.0;

// A shorter default where the theory or the record of the leader requires it.
void choose_steps(const PlatoonModel& model, RunOptions& run) {
  constexpr std::int64_t kFewestOfDrive = 10;
  std::int64_t fewest = run.steps;
  // A recorded drive as a whole.
  const double seconds = static_cast<double>(model.recorded_leader.size()) * model.sample_period;
  run.steps = chosen_steps(run, model.sample_period, std::max(seconds, kChosenSeconds));
  const auto followers = static_cast<double>(run.followers);
  if (needs_chain_moments(model) && !no_theory(model)) {
    run.steps = std::min(run.steps, most_chain_steps(model, run.followers, 0.2));
  } else if (has_independent_losses(model)) {
    run.steps = std::min(run.steps, static_cast<std::int64_t>(kMostLossResponses / (followers * followers)));
  }
  if (!model.recorded_leader.empty()) {
    const std::int64_t recorded = static_cast<std::int64_t>(model.recorded_leader.size()) - 1;
    run.steps = std::min(run.steps, recorded);
    fewest = std::clamp(recorded, kFewestOfDrive, fewest);
  }
  run.steps = std::max(run.steps, fewest);
}

void choose_burn_in(const PlatoonModel& model, RunOptions& run, std::vector<std::string>& problems) {
  if (run.averaging() != Averaging::over_time) return;
  const std::optional<std::int64_t> steps = settling_steps(model, run.followers);
  if (steps) {
    run.burn_in = *steps;
  } else {
    problems.emplace_back("run/burn_in: (empty): must be given, as the closed loop of a vehicle is unstable");
  }
}

// The control input of every follower must be known.
void require_inputs(const PlatoonModel& model, const RunOptions& run, std::vector<std::string>& problems) {
  if (std::find(run.signals.begin(), run.signals.end(), kInput) == run.signals.end()) return;
  const auto has_none = [](const VehicleModel& of) { return !of.loop.parts; };
  const std::vector<VehicleModel> vehicles = pattern(model);
  if (std::any_of(vehicles.begin(), vehicles.end(), has_none))
    problems.push_back(std::string("run/signals: input: must be absent unless ") + kWithInput);
  if (!run.external.empty()) problems.emplace_back("run/signals: input: must be absent beside external vehicles");
}

void require_amplification(const RunOptions& run, std::vector<std::string>& problems) {
  const bool has_speed = std::find(run.signals.begin(), run.signals.end(), "speed") != run.signals.end();
  if (!has_speed || run.burn_in == 0 || run.has_amplification()) return;
  problems.push_back(formatted(
      "run/burn_in: %lld: must be at most %lld, as amplification.csv needs two of the %lld steps",
      static_cast<long long>(run.burn_in), static_cast<long long>(run.steps - 2), static_cast<long long>(run.steps)));
}

}  // namespace

std::vector<std::string> signal_problems(const Configuration& configuration) {
  std::vector<std::string> problems;
  require_amplification(configuration.run, problems);
  require_inputs(configuration.model, configuration.run, problems);
  return problems;
}

Configuration parse_configuration(const YAML::Node& document, const PlatoonModel* known) {
  std::vector<std::string> problems;
  Section root(document, "", problems);
  require_version(root);
  if (!problems.empty()) throw ConfigurationError(problems);
  RunOptions run = read_run_options(root.section("run"));
  const bool is_run = problems.empty();
  const Section given = root.section("model");
  const std::optional<PlatoonModel> model = known != nullptr ? std::optional(*known) : read_model(given);
  if (model && is_run && run.steps_chosen) choose_steps(*model, run);
  root.reject_unknown_keys();
  if (model && is_run && !model->recorded_leader.empty()) {
    const auto needed = static_cast<std::size_t>(run.steps) + 1;
    if (run.averaging() == Averaging::over_time || model->recorded_leader.size() < needed) {
      problems.push_back("model/leader/positions: " + std::to_string(model->recorded_leader.size()) +
                         " given: must be at least steps + 1 = " + std::to_string(needed) + ", and steps above 0");
    }
  }
  if (model && is_run) require_feasible_theory(*model, run, problems);
  if (is_run && (model || !run.steps_chosen)) require_amplification(run, problems);
  if (model) require_inputs(*model, run, problems);
  if (model && is_run && run.burn_in_chosen) choose_burn_in(*model, run, problems);
  if (!problems.empty()) throw ConfigurationError(problems);
  return {*model, run, kVersion};
}

Configuration parse_configuration(const std::string& text) {
  return parse_configuration(parse_yaml(text, "configuration"));
}

Configuration parse_recorded_configuration(const std::string& text) {
  YAML::Node document = parse_yaml(text, "configuration");
  const std::string version = document.IsMap() && document["version"] ? document["version"].as<std::string>() : "0.1.0";
  if (!is_readable(version))
    throw ConfigurationError({"version: " + version + ": must be " + kFirstReadableVersion + " or " + kVersion});
  document["version"] = kVersion;
  Configuration configuration = parse_configuration(document);
  configuration.version = version;
  return configuration;
}

nlohmann::json to_json(const Configuration& configuration) {
  return {
      {"version", configuration.version}, {"model", to_json(configuration.model)}, {"run", to_json(configuration.run)}};
}

PlatoonModel model_within_run(const Configuration& configuration) {
  PlatoonModel model = configuration.model;
  const std::int64_t steps = configuration.run.steps;
  if (steps == 0) return model;
  std::vector<SpeedChange> changes = model.leader.changes();
  while (changes.size() > 1 && changes.back().from_step >= std::max<std::int64_t>(steps - 1, 1)) changes.pop_back();
  model.leader = LeaderProfile(changes, model.sample_period);
  std::vector<double>& recorded = model.recorded_leader;
  recorded.resize(std::min(recorded.size(), static_cast<std::size_t>(steps) + 1));
  return model;
}

SignalCells cells_of(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  return signal_cells(configuration.model, run.followers, run.steps, run.signals);
}

std::vector<std::size_t> measured_followers(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  std::vector<std::size_t> measured;
  if (run.averaging() == Averaging::over_time) return measured;
  for (std::size_t i = 1; i <= run.followers; ++i) {
    if (measures_input(configuration.model, run.signals, i) && !run.is_external(i)) measured.push_back(i);
  }
  return measured;
}

std::uint64_t run_identity(const Configuration& configuration) {
  const std::uint64_t identity = digest(to_json(configuration).dump());
  return identity == 0 ? 1 : identity;
}

nlohmann::json statistics_identity(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  nlohmann::json identity = to_json(configuration.model);
  identity["version"] = configuration.version;
  for (const VehicleType& type : configuration.model.types)
    identity["realization"][type.name] = to_json(type.vehicle.loop.realization);
  identity["seed"] = run.seed;
  identity["followers"] = run.followers;
  identity["steps"] = run.steps;
  if (!run.external.empty()) identity["external"] = run.external;
  if (!run.signals.empty()) identity["signals"] = run.signals;
  if (run.averaging() == Averaging::over_time || (run.has_amplification() && run.burn_in > 0))
    identity["burn_in"] = run.burn_in;
  return identity;
}

}  // namespace platoon
