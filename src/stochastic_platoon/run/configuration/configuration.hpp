#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "stochastic_platoon/run/configuration/run_options.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"

namespace platoon {

/// The configuration of every node and tool: the model and the run.
///
/// It is passed on as one JSON text: `configure` prints it, the parameter `configuration` holds it, the topic
/// `configuration` and bags carry it.
struct Configuration {
  PlatoonModel model;
  RunOptions run;
  std::string version = kVersion;  ///< of the package that wrote it; a part of the run's identity
};

/// Parses {version: .., model: .., run: ..}. Throws ConfigurationError with all problems of both, or if another version
/// of this package wrote the document. `known`: the model, in place of that in the document.
Configuration parse_configuration(const YAML::Node& document, const PlatoonModel* known = nullptr);
/// The same from text. Throws ConfigurationError if the text is not YAML (JSON is).
Configuration parse_configuration(const std::string& text);
/// The same from a recording, also of an earlier version that is_readable().
Configuration parse_recorded_configuration(const std::string& text);

/// What is wrong with the signals of the run, each with its key; empty if nothing is.
std::vector<std::string> signal_problems(const Configuration& configuration);

/// The model with the leader up to the last step of the run, whose speed is then the one of stationary values; of an
/// endless run the model as it is.
PlatoonModel model_within_run(const Configuration& configuration);

/// The cells of the run's statistics.
SignalCells cells_of(const Configuration& configuration);

/// The followers whose control inputs a run over realizations measures: see measures_input(). They publish them.
/// External vehicles do not.
std::vector<std::size_t> measured_followers(const Configuration& configuration);

/// JSON for parse_configuration().
nlohmann::json to_json(const Configuration& configuration);

/// The run's identity: a 64 bit digest (FNV-1a) of the configuration with its launch and this package's version, never
/// 0. Every message carries it.
std::uint64_t run_identity(const Configuration& configuration);

/// The inputs of the statistics, except the set of realizations: version, model with the bits of its closed loop, seed,
/// followers, steps.
nlohmann::json statistics_identity(const Configuration& configuration);

}  // namespace platoon
