#include "stochastic_platoon/run/report/string_text.hpp"

#include <algorithm>
#include <vector>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

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

/// ", hears ..."; several types by their names, or the first of many.
std::string hears_text(const PlatoonModel& model) {
  constexpr std::size_t kMost = 4;
  std::vector<std::size_t> types = type_order(model);
  std::sort(types.begin(), types.end());
  types.erase(std::unique(types.begin(), types.end()), types.end());
  if (types.size() == 1) return ", hears " + inputs_text(model.types[types.front()].vehicle);
  const std::size_t shown = types.size() > kMost ? kMost / 2 : types.size();
  std::string text;
  for (std::size_t t = 0; t < shown; ++t)
    text += ", " + model.types[types[t]].name + " hears " + inputs_text(model.types[types[t]].vehicle);
  return shown < types.size() ? text + formatted(", and %zu other types", types.size() - shown) : text;
}

}  // namespace

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

std::string string_text(const PlatoonModel& model) {
  const std::string spacing = spacing_text(model);
  if (!hears_predecessors_only(model)) return spacing + hears_text(model);
  std::vector<double> noises, radios;
  for (const VehicleModel& of : pattern(model)) {
    noises.push_back(of.position().noise_variance);
    if (of.radio() != nullptr) radios.push_back(of.radio()->noise_variance);
  }
  return spacing + ", P_d = " + range_text(noises) + " m^2" +
         (radios.empty() ? "" : ", radio " + range_text(radios) + " (m/s^2)^2");
}

}  // namespace platoon
