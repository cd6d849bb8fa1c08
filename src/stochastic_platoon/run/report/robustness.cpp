#include "stochastic_platoon/run/report/robustness.hpp"

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/report/json_value.hpp"

namespace platoon {

Robustness robustness(const PlatoonModel& model) {
  return {loop_margins(model), critical_delay(model)};
}

nlohmann::json to_json(const Robustness& found, double sample_period) {
  const auto value = [&found](double LoopMargins::*figure, double unit) {
    return found.margins ? number(*found.margins.*figure * unit) : nlohmann::json();
  };
  return {{"phase_margin", value(&LoopMargins::phase, 1.0)},
          {"delay_margin", value(&LoopMargins::delay, sample_period)},
          {"sensitivity_peak", value(&LoopMargins::sensitivity_peak, 1.0)},
          {"critical_delay",
           found.critical_delay.steps ? number(*found.critical_delay.steps * sample_period) : nlohmann::json()}};
}

std::string report(const PlatoonModel& model, const Robustness& found) {
  std::string text;
  if (found.margins) {
    const LoopMargins& margins = *found.margins;
    text += std::isnan(margins.phase) ? std::string("Phase margin and delay margin: none, as |L| is 1 at no frequency")
                                      : formatted("Phase margin %.6g deg, delay margin %.6g s", margins.phase,
                                                  margins.delay * model.sample_period);
    text += formatted("; peak of the sensitivity %.6g at w = %s\n", margins.sensitivity_peak,
                      frequency_text(margins.peak_frequency, model.sample_period).c_str());
  }
  if (hears_by_radio(model)) {
    text += "Critical delay of the radio: " +
            (found.critical_delay.steps ? formatted("%.6g s", *found.critical_delay.steps * model.sample_period)
                                        : "none, as " + found.critical_delay.reason) +
            "\n";
  }
  return text;
}

}  // namespace platoon
