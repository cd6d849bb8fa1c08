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
          {"leader_bags", ""},
          {"first_realization", "0"},
          {"record", ""},
          {"record_split_mb", "0"},
          {"record_compression", "none"},
          {"window", "0"},
          {"stall_timeout", "2.0"},
          {"burn_in", "200"}};
}

namespace {

void require_known(const std::map<std::string, std::string>& settings) {
  const std::map<std::string, std::string> known = default_settings();
  std::vector<std::string> problems;
  std::string allowed;
  for (const auto& entry : known) allowed += (allowed.empty() ? "" : ", ") + entry.first;
  for (const auto& entry : settings) {
    if (known.count(entry.first) == 0)
      problems.push_back(entry.first + ": unknown setting: allowed are " + allowed);
  }
  if (!problems.empty()) throw ConfigurationError(problems);
}

// Which settings are part of the model, and their keys there.
const std::map<std::string, std::string> kModelKeys = {{"headway", "time_headway"},
                                                       {"noise_variance", "noise_variance"}};

// A model that is no mapping takes no override: read_model() says what is wrong with it.
void override_with(const std::map<std::string, std::string>& settings, YAML::Node& document) {
  const bool model_takes_keys = document["model"].IsMap();
  for (const auto& entry : settings) {
    if (entry.first == "model") continue;
    const auto model_key = kModelKeys.find(entry.first);
    if (model_key == kModelKeys.end()) {
      document["run"][entry.first] = entry.second;
    } else if (!entry.second.empty() && model_takes_keys) {
      document["model"][model_key->second] = entry.second;
    }
  }
}

}  // namespace

YAML::Node configuration_document(const std::map<std::string, std::string>& settings) {
  require_known(settings);
  std::map<std::string, std::string> values = default_settings();
  for (const auto& entry : settings) values[entry.first] = entry.second;
  YAML::Node document;
  document["model"] = load_yaml(values["model"]);
  override_with(values, document);
  return document;
}

YAML::Node configuration_document(const Configuration& base,
                                  const std::map<std::string, std::string>& settings) {
  require_known(settings);
  YAML::Node document = YAML::Load(to_json(base).dump());
  const auto model = settings.find("model");
  if (model != settings.end() && !model->second.empty()) document["model"] = load_yaml(model->second);
  override_with(settings, document);
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
  identity["leader_bags"] = configuration.run.leader_bags;
  return identity;
}

}  // namespace platoon
