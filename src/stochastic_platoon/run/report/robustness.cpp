#include "stochastic_platoon/run/report/robustness.hpp"

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/critical_delay.hpp"
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
           found.critical_radio_delay ? number(*found.critical_radio_delay * sample_period) : nlohmann::json()}};
}

std::string report(const PlatoonModel& model, const Robustness& found) {
  std::string text;
  if (found.margins) {
    const LoopMargins& margins = *found.margins;
    text += std::isnan(margins.phase) ? std::string("Phase margin and delay margin: none, as |L| is 1 at no frequency")
                                      : formatted("Phase margin %.6g deg, delay margin %.6g s", margins.phase,
                                                  margins.delay * model.sample_period);
    text += formatted("; peak of the sensitivity %.6g at w = %.6g rad/sample\n", margins.sensitivity_peak,
                      margins.peak_frequency);
  }
  if (hears_by_radio(model)) {
    text += "Critical delay of the radio: " +
            (found.critical_radio_delay ? formatted("%.6g s", *found.critical_radio_delay * model.sample_period)
                                        : std::string("none")) +
            "\n";
  }
  return text;
}

}  // namespace platoon
