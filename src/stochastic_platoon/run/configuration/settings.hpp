#pragma once

#include <string>
#include <vector>

namespace platoon {

/// One argument of platoon.launch, and option of the tools that take it: the one place where its name, its
/// default and its meaning stand.
struct Setting {
  const char* name;           ///< "noise_variance"; as an option --noise-variance
  const char* default_value;  ///< as text
  const char* help;
  /// The key of the model file that it overrides where it is not empty, of nested ones "a/b"; null: none.
  const char* model_key;
};

/// All settings but `model`, the model file's name.
const std::vector<Setting>& settings();

/// The batch of a Monte Carlo, where none is asked for: what a vehicle needs of so many realizations side by side
/// fits the second level cache.
constexpr char kMonteCarloBatch[] = "512";

}  // namespace platoon
