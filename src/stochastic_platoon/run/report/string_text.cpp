#include "stochastic_platoon/run/report/string_text.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"

namespace platoon {

namespace {

const std::map<InputSignal, const char*> kNoises = {{InputSignal::position, "P_d = %s m^2"},
                                                    {InputSignal::speed, "speed %s (m/s)^2"},
                                                    {InputSignal::acceleration, "acceleration %s (m/s^2)^2"},
                                                    {InputSignal::input, "radio %s (m/s^2)^2"}};

/// "0.8", or "0.8 to 1.2".
std::string range_text(const std::vector<double>& values, double unit = 1.0) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const std::string low = formatted("%g", *least * unit), high = formatted("%g", *most * unit);
  return low == high ? low : low + " to " + high;
}

/// "position of the leader (0.4), position of vehicle i-1 (0.6)".
std::string inputs_text(const VehicleModel& of) {
  std::string text;
  for (const Input& input : of.inputs)
    text += (text.empty() ? "" : ", ") + text_of(input) + formatted(" (%g)", input.gain);
  return text;
}

/// ", hears ..."; unlike types by their names, or the first of many.
std::string hears_text(const PlatoonModel& model) {
  constexpr std::size_t kMost = 4;
  std::map<std::size_t, std::string> texts;
  for (const std::size_t type : type_order(model)) texts[type] = " hears " + inputs_text(model.types[type].vehicle);
  const std::string& first = texts.begin()->second;
  if (std::all_of(texts.begin(), texts.end(), [&first](const auto& of) { return of.second == first; }))
    return "," + first;
  const std::size_t shown = texts.size() > kMost ? kMost / 2 : texts.size();
  std::string text;
  auto next = texts.begin();
  for (std::size_t t = 0; t < shown; ++t, ++next) text += ", " + model.types[next->first].name + next->second;
  return shown < texts.size() ? text + formatted(", and %zu other types", texts.size() - shown) : text;
}

}  // namespace

std::string speed_text(const Configuration& configuration) {
  const PlatoonModel& model = configuration.model;
  if (!loses(model) || no_theory(model)) return "";
  return formatted(" at %.6g m/s", metres_per_step(model_within_run(configuration)) / model.sample_period);
}

std::string spacing_text(const PlatoonModel& model) {
  std::vector<double> headways, distances;
  for (const VehicleModel& of : pattern(model))
    of.constant_spacing ? distances.push_back(of.standstill_distance) : headways.push_back(of.headway);
  std::string text;
  if (!headways.empty())
    text = "h = " + range_text(headways, model.sample_period) + " s (" + range_text(headways) + " sample periods)";
  if (!distances.empty()) text += (text.empty() ? "" : ", ") + ("constant spacing of " + range_text(distances) + " m");
  return text;
}

std::string text_of(const Input& input) {
  const std::string source = input.ahead == Input::kLeader ? "the leader" : formatted("vehicle i-%zu", input.ahead);
  return std::string(name_of(input.signal)) + " of " + source;
}

std::string noise_text(const PlatoonModel& model) {
  std::map<InputSignal, std::vector<double>> noises;
  for (const VehicleModel& of : pattern(model)) {
    for (const Input& input : of.inputs) noises[input.signal].push_back(input.noise_variance);
  }
  std::string text;
  for (const auto& [signal, variances] : noises)
    text += (text.empty() ? "" : ", ") + formatted(kNoises.at(signal), range_text(variances).c_str());
  return text;
}

std::string string_text(const PlatoonModel& model) {
  return spacing_text(model) + ", " + noise_text(model) + (hears_predecessors_only(model) ? "" : hears_text(model));
}

}  // namespace platoon
