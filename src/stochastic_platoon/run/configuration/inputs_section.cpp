#include "stochastic_platoon/run/configuration/inputs_section.hpp"

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/run/configuration/link_section.hpp"

namespace platoon {

namespace {

constexpr std::int64_t kLongestRadioDelay = 100;

Input read_radio(Section& input, bool allow_unstable) {
  Input radio{InputSignal::input};
  const std::size_t before = input.problems();
  if (input.has("gain")) radio.gain = input.number("gain", kAnyFinite);
  if (input.problems() == before && radio.gain == 0.0)
    input.reject("gain", "0", "other than 0: without it there is no radio");
  radio.noise_variance = input.number("noise_variance", kNotNegative);
  Section channel = input.section("channel");
  if (channel.is_mapping() && !channel.has("delay")) {
    channel.reject("delay", "missing", "1 or more: the input of step k is known one step later");
  } else if (channel.is_mapping()) {
    radio.link = read_link(channel, LinkModel(), allow_unstable, InputSignal::input);
    const std::int64_t m = radio.link.delay;
    if (m < 1) channel.reject("delay", std::to_string(m), "1 or more: the input of step k is known one step later");
    if (m > kLongestRadioDelay)
      channel.reject("delay", std::to_string(m),
                     "at most " + std::to_string(kLongestRadioDelay) + " steps for a radio");
  }
  return radio;
}

}  // namespace

GivenInputs read_inputs(Section& section, VehicleModel& vehicle, bool allow_unstable) {
  GivenInputs given;
  vehicle.inputs = {{InputSignal::position, vehicle.position().noise_variance}};
  Input& own_position = vehicle.position();
  std::optional<Input> radio;
  std::size_t positions = 0, inputs = 0;
  for (Section& input : section.sections("inputs")) {
    const std::size_t before = input.problems();
    const std::string signal = input.choice("signal", {"position", "input"});
    if (input.problems() > before) return given;
    if (input.has("from")) input.choice("from", {"predecessor"});
    if (signal == "input" && ++inputs == 1) {
      radio = read_radio(input, allow_unstable);
    } else if (signal == "position" && ++positions == 1) {
      given = {input.has("noise_variance"), input.has("channel")};
      if (given.noise_variance) own_position.noise_variance = input.number("noise_variance", kNotNegative);
      if (given.channel) own_position.link = read_link(input.section("channel"), own_position.link, allow_unstable);
    }
    if (inputs < 2 && positions < 2) input.reject_unknown_keys();
  }
  if (radio) vehicle.inputs.push_back(*radio);
  if (positions != 1)
    section.reject("inputs", std::to_string(positions) + " positions", "one position, and one input or none");
  if (inputs > 1) section.reject("inputs", std::to_string(inputs) + " inputs", "one position, and one input or none");
  const auto only_once = [&](const char* key, bool twice) {
    if (twice && section.has(key)) section.reject(key, "given", "absent beside that of the position in inputs");
  };
  only_once("noise_variance", given.noise_variance);
  only_once("channel", given.channel);
  return given;
}

nlohmann::json inputs_json(const VehicleModel& vehicle) {
  nlohmann::json inputs = {{{"signal", "position"}, {"from", "predecessor"}}};
  if (const Input* const radio = vehicle.radio()) {
    inputs.push_back({{"signal", name_of(radio->signal)},
                      {"from", "predecessor"},
                      {"gain", radio->gain},
                      {"noise_variance", radio->noise_variance},
                      {"channel", to_json(radio->link)}});
  }
  return inputs;
}

void check_radios(PlatoonModel& model, Section& document) {
  if (!has_radios(model)) return;
  const std::size_t before = document.problems();
  for (VehicleType& type : model.types) {
    const auto report = [&](const std::string& problem) {
      const bool is_default = &type == &model.types.front();
      document.report((is_default ? "" : "vehicle_types/" + type.name + "/") + problem);
    };
    if (!type.vehicle.design) {
      report(
          "closed_loop: given: must be plant and controller: vehicles with a radio are sent the control inputs of others");
    } else if (type.vehicle.design->plant.exact().integrators() < 2) {
      report(
          "plant: no double integrator: must have two poles at z = 1 (s = 0), as vehicles with a radio are sent its input, an acceleration");
    }
  }
  if (document.problems() > before) return;
  for (VehicleType& type : model.types) {
    type.vehicle.design->sends_input = true;
    type.vehicle.loop = close_loop(*type.vehicle.design, type.vehicle.headway);
  }
}

}  // namespace platoon
