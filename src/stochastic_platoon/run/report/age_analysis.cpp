#include "stochastic_platoon/run/report/age_analysis.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/channel/information_age.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

bool has_distribution(const LinkModel& link) {
  return link.loses() && !link.loss->trace && !link.loss->by_distance;
}

nlohmann::json probabilities_of(const LinkModel& link) {
  if (!link.loses()) return {1.0};
  if (!has_distribution(link)) return nullptr;
  return age_probabilities(*link.loss);
}

}  // namespace

std::string age_report(const PlatoonModel& model) {
  std::optional<LossModel> oldest;
  any_link(model, [&oldest](const LinkModel& link) {
    if (has_distribution(link) && (!oldest || mean_age(*link.loss) > mean_age(*oldest))) oldest = link.loss;
    return false;
  });
  if (!oldest) return "";
  return formatted(
      "Age of information: %.6g s (%.6g steps) since the last arrival on average, at most %.6g s (%.0f steps) in all but 1e-6 of the steps\n",
      mean_age(*oldest) * model.sample_period, mean_age(*oldest),
      age_exceeded_with(*oldest, 1e-6) * model.sample_period, age_exceeded_with(*oldest, 1e-6));
}

nlohmann::json ages_to_json(const PlatoonModel& model, std::size_t followers) {
  if (!loses(model)) return nullptr;
  nlohmann::json ages = {{"position", nlohmann::json::array()}, {"inputs", nlohmann::json::array()}};
  if (has_radios(model)) ages["input"] = nlohmann::json::array();
  for (std::size_t i = 1; i <= followers; ++i) {
    const VehicleModel& of = vehicle(model, i);
    nlohmann::json own = nlohmann::json::array();
    for (const Input& input : of.inputs) own.push_back(probabilities_of(input.link));
    ages["position"].push_back(own[static_cast<std::size_t>(&of.position() - of.inputs.data())]);
    if (ages.contains("input")) {
      const auto radio = std::find_if(of.inputs.begin(), of.inputs.end(),
                                      [](const Input& input) { return input.signal == InputSignal::input; });
      const bool is_there = radio != of.inputs.end();
      ages["input"].push_back(is_there ? own[static_cast<std::size_t>(radio - of.inputs.begin())] : nlohmann::json());
    }
    ages["inputs"].push_back(std::move(own));
  }
  return ages;
}

}  // namespace platoon
