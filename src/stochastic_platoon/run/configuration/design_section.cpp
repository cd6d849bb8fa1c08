#include "stochastic_platoon/run/configuration/design_section.hpp"

#include <stdexcept>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/fraction.hpp"

namespace platoon {

namespace {

Plant placeholder_plant() {
  return TransferFunction{Polynomial::Ones(1), Eigen::Vector2d(1.0, 0.0)};  // a delay of one step
}

double optional_number(Section& section, const char* key, const Allowed& allowed) {
  return section.has(key) ? section.number(key, allowed) : 0.0;
}

// The continuous plant with its input delay. `before`: number of problems before its section was read.
Plant sampled(Section& section, ContinuousPlant plant, double sample_period, std::size_t before) {
  plant.input_delay = optional_number(section, "input_delay", kNotNegative);
  section.reject_unknown_keys();
  const double longest = kLongestInputDelay * sample_period;
  if (plant.input_delay > longest)
    section.reject("input_delay", formatted("%g s", plant.input_delay),
                   formatted("at most %ld sample periods, %g s", kLongestInputDelay, longest));
  if (section.problems() > before || !(sample_period > 0.0)) return placeholder_plant();
  try {
    return Plant(plant, sample_period);
  } catch (const std::invalid_argument& error) {
    section.report_whole(error.what());
    return placeholder_plant();
  }
}

Plant read_continuous(Section section, double sample_period) {
  const std::size_t before = section.problems();
  const TransferFunction fraction = read_fraction_of(section);
  if (section.problems() == before) {
    const Polynomial &n = fraction.numerator(), &d = fraction.denominator();
    if (!fraction.is_strictly_proper() || n(0) == 0.0)
      section.reject("numerator", formatted("degree %ld", static_cast<long>(n.size() - 1)),
                     "a polynomial other than 0 of a lower degree than the denominator's");
    if (d.size() < 3 || d(d.size() - 1) != 0.0 || d(d.size() - 2) != 0.0)
      section.reject("denominator", "no double integrator",
                     "a polynomial that ends in two zeros: two poles at s = 0 lead from acceleration to position");
  }
  if (section.problems() > before) return sampled(section, {}, sample_period, before);
  // The given numbers, because TransferFunction divides by the leading coefficient of its denominator, which rounds.
  return sampled(section, {section.numbers("numerator"), section.numbers("denominator")}, sample_period, before);
}

Plant read_plant(Section section, double sample_period) {
  const std::size_t before = section.problems();
  if (section.has("actuator_lag")) {
    const double lag = section.number("actuator_lag", kNotNegative);
    return sampled(section, car_with_actuator_lag(lag, 0.0), sample_period, before);
  }
  if (section.has("continuous")) {
    Plant plant = read_continuous(section.section("continuous"), sample_period);
    section.reject_unknown_keys();
    return plant;
  }
  const TransferFunction plant = read_fraction(section);
  return section.problems() == before ? Plant(plant) : placeholder_plant();
}

Controller read_controller(Section& section, double sample_period) {
  const std::size_t before = section.problems();
  if (!section.has("kp") && !section.has("kd") && !section.has("ki")) return read_fraction(section);
  const ControllerGains gains{section.number("kp", kAnyFinite), section.number("kd", kAnyFinite),
                              optional_number(section, "ki", kAnyFinite)};
  section.reject_unknown_keys();
  if (section.problems() == before && gains.kp == 0.0 && gains.kd == 0.0 && gains.ki == 0.0)
    section.reject("kp", "0, as are the others", "a gain other than 0, or kd or ki");
  if (section.problems() == before && sample_period > 0.0) return {gains, sample_period};
  return TransferFunction{Polynomial::Ones(1), Polynomial::Ones(1)};
}

}  // namespace

LoopDesign placeholder_design() {
  return {placeholder_plant(), TransferFunction{Polynomial::Ones(1), Polynomial::Ones(1)}};
}

LoopDesign read_design(Section& vehicle, const std::optional<LoopDesign>& base, double sample_period) {
  LoopDesign design = base.value_or(placeholder_design());
  if (!base || vehicle.has("plant")) design.plant = read_plant(vehicle.section("plant"), sample_period);
  if (base && !vehicle.has("controller")) return design;
  Section section = vehicle.section("controller");
  const auto flag = [&](const char* key) { return section.has(key) && section.boolean(key); };
  design.divide_by_one_plus_headway = flag("divide_by_one_plus_headway");
  design.headway_filter = flag("headway_filter");
  if (design.divide_by_one_plus_headway && design.headway_filter)
    section.reject("headway_filter", "true", "false beside divide_by_one_plus_headway: true, as each divides K");
  design.controller = read_controller(section, sample_period);
  return design;
}

nlohmann::json to_json(const Plant& plant) {
  if (const auto* sampled = std::get_if<TransferFunction>(&plant.given())) return to_json(*sampled);
  const ContinuousPlant& continuous = std::get<ContinuousPlant>(plant.given());
  return {{"continuous",
           {{"numerator", to_list(continuous.numerator)},
            {"denominator", to_list(continuous.denominator)},
            {"input_delay", continuous.input_delay}}}};
}

nlohmann::json controller_json(const LoopDesign& design) {
  nlohmann::json document;
  if (const auto* sampled = std::get_if<TransferFunction>(&design.controller.given())) {
    document = to_json(*sampled);
  } else {
    const ControllerGains& gains = std::get<ControllerGains>(design.controller.given());
    document = {{"kp", gains.kp}, {"kd", gains.kd}, {"ki", gains.ki}};
  }
  // An absent key is false; the first is always written, so that the text of the paper's platoon never changes.
  document["divide_by_one_plus_headway"] = design.divide_by_one_plus_headway;
  if (design.headway_filter) document["headway_filter"] = true;
  return document;
}

}  // namespace platoon
