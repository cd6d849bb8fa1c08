#include "stochastic_platoon/configuration/configuration.hpp"

namespace platoon {

Configuration parse_configuration(const YAML::Node& node) {
  std::vector<std::string> problems;
  Section document(node, "", problems);
  if (!problems.empty()) throw ConfigurationError(problems);
  const RunOptions run = read_run_options(document.section("run"));
  const std::optional<PlatoonModel> model = read_model(document.section("model"), problems);
  document.reject_unknown_keys();
  if (!problems.empty()) throw ConfigurationError(problems);
  return {*model, run};
}

std::map<std::string, std::string> default_settings() {
  return {{"model", ""},
          {"headway", ""},
          {"noise_variance", ""},
          {"followers", "20"},
          {"steps", "100"},
          {"realizations", "10000"},
          {"batch", "0"},
          {"rate", "0"},
          {"seed", "1"},
          {"hosting", "processes"},
          {"output", ""},
          {"resume", "false"},
          {"launch", ""},
          {"first_realization", "0"},
          {"record", ""},
          {"record_split_mb", "0"},
          {"record_compression", "none"},
          {"window", "0"},
          {"stall_timeout", "2.0"},
          {"burn_in", "200"}};
}

YAML::Node configuration_document(const std::map<std::string, std::string>& settings) {
  std::map<std::string, std::string> values = default_settings();
  std::vector<std::string> problems;
  std::string allowed;
  for (const auto& entry : values) allowed += (allowed.empty() ? "" : ", ") + entry.first;
  for (const auto& entry : settings) {
    if (values.count(entry.first) == 0)
      problems.push_back(entry.first + ": unknown setting: allowed are " + allowed);
    values[entry.first] = entry.second;
  }
  if (!problems.empty()) throw ConfigurationError(problems);
  YAML::Node model = load_yaml(values["model"]);
  if (!values["headway"].empty()) model["time_headway"] = values["headway"];
  if (!values["noise_variance"].empty()) model["noise_variance"] = values["noise_variance"];
  YAML::Node run;
  for (const auto& entry : values) {
    if (entry.first == "model" || entry.first == "headway" || entry.first == "noise_variance") continue;
    run[entry.first] = entry.second;
  }
  YAML::Node document;
  document["model"] = model;
  document["run"] = run;
  return document;
}

nlohmann::json to_json(const Configuration& configuration) {
  return {{"model", to_json(configuration.model)}, {"run", to_json(configuration.run)}};
}

nlohmann::json statistics_identity(const Configuration& configuration) {
  nlohmann::json identity = to_json(configuration.model);
  identity["seed"] = configuration.run.seed;
  identity["followers"] = configuration.run.followers;
  identity["steps"] = configuration.run.steps;
  return identity;
}

}  // namespace platoon
