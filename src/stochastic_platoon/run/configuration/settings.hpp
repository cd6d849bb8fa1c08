#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "stochastic_platoon/run/configuration/run_options.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// A value of RunOptions in a document.
struct RunValue {
  /// Reads the value at a key of the section; a fault is added to the section's problems.
  std::function<void(Section& section, const std::string& key, RunOptions& run)> read;
  /// Null if the key is left out, so that the text of runs without the option never changes.
  std::function<nlohmann::json(const RunOptions& run)> write;
};

/// One argument of platoon.launch, and an option of the tools that take it: its name, default and meaning.
/// platoon.launch repeats them, because roslaunch cannot read them from here; settings_test compares both. Readers,
/// writers, parameters, --help and sweeps go through these rows.
struct Setting {
  const char* name;           ///< "noise_variance"; as an option --noise-variance
  const char* default_value;  ///< as text
  const char* help;
  /// The model file key that a non-empty value overrides, nested keys as "a/b"; null: none.
  const char* model_key;
  /// Further model file keys that a value replaces: the same quantity in another unit or form.
  std::vector<const char*> replaces = {};
  RunValue of_run = {};  ///< of a setting without model file key
};

/// All settings except `model`, the name of the model file.
const std::vector<Setting>& settings();

/// The faults of names that are set one after the other, each a setting or a model file key, in which a later one would
/// silently drop an earlier one: both stand for one key, one replaces the other's, or the earlier key is within the
/// later.
std::vector<std::string> conflicts(const std::vector<std::string>& names);

/// Default batch sizes of a Monte Carlo: the data of a vehicle for that many realizations fit the second level cache.
/// With signals a batch costs more, and the larger size spreads its fixed cost over more realizations.
constexpr char kMonteCarloBatch[] = "512", kMonteCarloBatchWithSignals[] = "1024";

/// Adds the default batch of a Monte Carlo to the given settings, unless they have one.
void add_monte_carlo_batch(std::map<std::string, std::string>& given);

}  // namespace platoon
