#include "stochastic_platoon/run/report/linear_theory.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/linear_model.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/beyond_limits.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "stochastic_platoon/run/report/json_value.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"

namespace platoon {

namespace {

constexpr double kShareForLinear = 0.05;  // of half a minute, of chain_moments()

std::vector<double> largest_of_steps(const Configuration& configuration, const std::vector<double>& cells) {
  std::vector<double> largest;
  for (std::size_t i = 1; !cells.empty() && i <= configuration.run.followers; ++i) {
    const auto first = cells.begin() + static_cast<std::ptrdiff_t>(cell(i, 0, configuration.run.steps));
    largest.push_back(*std::max_element(first, first + configuration.run.steps));
  }
  return largest;
}

}  // namespace

Configuration linear_configuration(Configuration configuration) {
  RunOptions& run = configuration.run;
  configuration.model = without_limits(configuration.model, run.steps);
  // Steps that were chosen for a run without a theory may be more than its exact moments can have.
  if (run.steps_chosen && needs_chain_moments(configuration.model) && !no_theory(configuration.model))
    run.steps = std::min(run.steps, most_chain_steps(configuration.model, run.followers, kShareForLinear));
  return configuration;
}

std::vector<double> beyond_limits(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  const PlatoonModel linear = linear_configuration(configuration).model;
  const std::vector<VehicleModel> vehicles = pattern(linear);
  const bool has_inputs =
      std::all_of(vehicles.begin(), vehicles.end(), [](const VehicleModel& of) { return of.loop.parts.has_value(); });
  if (run.steps == 0 || !has_inputs || no_theory(linear) || !has_normal_errors(linear)) return {};
  return probability_beyond_limits(configuration.model, run.followers, run.steps);
}

std::string beyond_limits_report(const Configuration& configuration, const std::vector<double>& cells) {
  const std::vector<double> largest = largest_of_steps(configuration, cells);
  std::string text;
  for (std::size_t i = 0; i < largest.size(); ++i) {
    if (std::isnan(largest[i])) continue;
    text += formatted("%s%.4g (follower %zu)", text.empty() ? "" : ", ", largest[i], i + 1);
  }
  return text.empty() ? text : "Linear input beyond its limits: probability per step up to " + text + "\n";
}

nlohmann::json linear_json(const Configuration& configuration) {
  const PlatoonModel linear = linear_configuration(configuration).model;
  const std::optional<std::string> reason = no_theory(linear);
  nlohmann::json document = {{"theory", name_of_theory(!reason)}};
  if (reason) {
    document["reason"] = reason_without_theory(*reason);
    return document;
  }
  const auto theory = StringTheory::of(linear);
  document.update(to_json(string_stability(*theory)));
  document["stationary_variance"] = numbers(stationary_variances(*theory, configuration.run.followers));
  const std::vector<double> largest = largest_of_steps(configuration, beyond_limits(configuration));
  document["probability_beyond_input_limits"] = largest.empty() ? nlohmann::json() : numbers(largest);
  return document;
}

}  // namespace platoon
