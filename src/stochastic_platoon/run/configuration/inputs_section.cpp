#include "stochastic_platoon/run/configuration/inputs_section.hpp"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/link_section.hpp"

namespace platoon {

namespace {

constexpr std::int64_t kLongestRadioDelay = 100, kFarthest = 100;
constexpr std::size_t kMostInputs = 32;
constexpr char kOneStepLater[] = "the input of step k is known one step later";

InputSignal signal_named(const std::string& name) {
  for (const InputSignal signal : {InputSignal::speed, InputSignal::acceleration, InputSignal::input}) {
    if (name == name_of(signal)) return signal;
  }
  return InputSignal::position;
}

std::size_t read_source(Section& input) {
  if (!input.has("from")) return 1;
  const std::string from = input.text("from");
  if (from == "predecessor") return 1;
  if (from == "leader") return Input::kLeader;
  char* end = nullptr;
  const long ahead = std::strtol(from.c_str(), &end, 10);
  if (!from.empty() && *end == '\0' && ahead >= 1 && ahead <= kFarthest) return static_cast<std::size_t>(ahead);
  input.reject("from", from,
               "predecessor, leader, or a number of vehicles ahead from 1 to " + std::to_string(kFarthest));
  return 1;
}

LinkModel read_input_link(Section channel, Input& input, const LinkModel& base, bool allow_unstable) {
  if (!channel.is_mapping()) return base;
  if (channel.has("packet")) input.packet = channel.text("packet");
  const bool sends_input = input.signal == InputSignal::input;
  if (sends_input && !channel.has("delay")) {
    channel.reject("delay", "missing", std::string("1 or more: ") + kOneStepLater);
    return base;
  }
  const LinkModel link = read_link(channel, base, allow_unstable, input.signal);
  if (sends_input && link.delay < 1)
    channel.reject("delay", std::to_string(link.delay), std::string("1 or more: ") + kOneStepLater);
  if (sends_input && link.delay > kLongestRadioDelay)
    channel.reject("delay", std::to_string(link.delay),
                   "at most " + std::to_string(kLongestRadioDelay) + " steps for a radio");
  if (link.loss && link.loss->by_distance && input.ahead != 1)
    channel.reject("loss", "by_distance", "probability, markov or a trace unless the input is from the predecessor");
  return link;
}

// One input. `first`: whether its noise_variance and channel may stand at the vehicle, as those of the first position.
Input read_input(Section& section, InputSignal signal, bool first, const VehicleModel& vehicle, bool allow_unstable) {
  Input input{signal};
  const std::size_t before = section.problems();
  input.ahead = read_source(section);
  if (signal == InputSignal::position) {
    if (section.has("weight")) input.gain = section.number("weight", kAnyFinite);
  } else {
    if (signal != InputSignal::input || section.has("gain")) input.gain = section.number("gain", kAnyFinite);
    if (section.problems() == before && input.gain == 0.0)
      section.reject("gain", "0",
                     signal == InputSignal::input ? "other than 0: without it there is no radio"
                                                  : "other than 0: without it the signal has no use");
  }
  if (first) input.noise_variance = vehicle.position().noise_variance;
  if (!first || section.has("noise_variance")) input.noise_variance = section.number("noise_variance", kNotNegative);
  if (signal == InputSignal::input && !section.has("channel")) {
    section.reject("channel", "missing", std::string("{delay: 1} or more: ") + kOneStepLater);
  } else if (section.has("channel")) {
    input.link = read_input_link(section.section("channel"), input, input.link, allow_unstable);
  }
  section.reject_unknown_keys();
  return input;
}

// The inputs of a packet share the losses of the first of them.
void share_losses(Section& section, VehicleModel& vehicle) {
  std::vector<Input>& inputs = vehicle.inputs;
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const std::size_t first = vehicle.losses_of(n);
    if (first == n) continue;
    if (inputs[n].ahead != inputs[first].ahead)
      section.reject("inputs", "packet " + inputs[n].packet + " from several vehicles", "packets of one vehicle each");
    if (!inputs[n].link.loss) {
      inputs[n].link.loss = inputs[first].link.loss;
    } else if (!(inputs[n].link.loss == inputs[first].link.loss)) {
      section.reject("inputs", "different losses in packet " + inputs[n].packet,
                     "one loss per packet, at the first of its inputs");
    }
    if (inputs[n].signal == InputSignal::position && inputs[n].link.loses() && inputs[n].link.loss->predictor.empty())
      section.reject("inputs", "on_loss zero of packet " + inputs[n].packet + ", which holds a position",
                     "hold, extrapolate or a list of weights: a lost position is none at 0 m");
  }
}

void check_positions(Section& section, const VehicleModel& vehicle) {
  double sum = 0.0;
  for (const Input& input : vehicle.inputs) {
    if (input.signal != InputSignal::position) continue;
    sum += input.gain;
    if (input.ahead == Input::kLeader && !vehicle.constant_spacing)
      section.reject("inputs", "a position from the leader",
                     "of vehicles at a number ahead unless spacing is constant: with a headway the distance to the "
                     "leader would grow along the string");
  }
  if (!(std::abs(sum - 1.0) <= 1e-9))
    section.reject("inputs", formatted("positions of weights that sum to %.12g", sum),
                   "positions of weights that sum to 1");
  if (vehicle.inputs.size() > kMostInputs)
    section.reject("inputs", std::to_string(vehicle.inputs.size()) + " inputs",
                   "at most " + std::to_string(kMostInputs));
}

}  // namespace

GivenInputs read_inputs(Section& section, VehicleModel& vehicle, bool allow_unstable) {
  GivenInputs given;
  const std::size_t at_first = section.problems();
  std::vector<Input> inputs;
  bool has_position = false;
  for (Section& input : section.sections("inputs")) {
    const std::size_t before = input.problems();
    const InputSignal signal = signal_named(input.choice("signal", {"position", "speed", "acceleration", "input"}));
    if (input.problems() > before) return given;
    const bool first = signal == InputSignal::position && !has_position;
    if (first) given = {input.has("noise_variance"), input.has("channel")};
    has_position = has_position || first;
    inputs.push_back(read_input(input, signal, first, vehicle, allow_unstable));
  }
  if (section.problems() == at_first && !has_position) section.reject("inputs", "no position", "at least one position");
  if (section.problems() > at_first) return given;
  // One position and one control input of the predecessor have their places, whatever the order in the file.
  if (inputs.size() == 2 && inputs.front().signal == InputSignal::input &&
      inputs.back().signal == InputSignal::position)
    std::swap(inputs.front(), inputs.back());
  vehicle.inputs = std::move(inputs);
  check_positions(section, vehicle);
  share_losses(section, vehicle);
  const auto only_once = [&](const char* key, bool twice) {
    if (twice && section.has(key)) section.reject(key, "given", "absent beside that of the position in inputs");
  };
  only_once("noise_variance", given.noise_variance);
  only_once("channel", given.channel);
  return given;
}

namespace {

nlohmann::json to_json(const Input& input) {
  nlohmann::json written = {{"signal", name_of(input.signal)}, {"noise_variance", input.noise_variance}};
  written[input.signal == InputSignal::position ? "weight" : "gain"] = input.gain;
  if (input.ahead == Input::kLeader) {
    written["from"] = "leader";
  } else if (input.ahead > 1) {
    written["from"] = input.ahead;
  } else {
    written["from"] = "predecessor";
  }
  nlohmann::json channel = to_json(input.link);
  if (!input.packet.empty()) channel["packet"] = input.packet;
  if (!channel.empty()) written["channel"] = channel;
  return written;
}

}  // namespace

nlohmann::json inputs_json(const VehicleModel& vehicle) {
  nlohmann::json inputs = nlohmann::json::array();
  for (std::size_t n = 0; n < vehicle.inputs.size(); ++n) {
    inputs.push_back(to_json(vehicle.inputs[n]));
    if (vehicle.losses_of(n) != n) inputs.back()["channel"].erase("loss");
  }
  if (vehicle.hears_predecessor_only()) inputs.front() = {{"signal", "position"}, {"from", "predecessor"}};
  return inputs;
}

void check_hearing(PlatoonModel& model, Section& document) {
  const bool plain = hears_predecessors_only(model);
  if (plain && !has_radios(model)) return;
  const std::size_t before = document.problems();
  const std::string who = plain ? "vehicles with a radio" : "vehicles that hear others than their predecessor";
  for (VehicleType& type : model.types) {
    const auto report = [&](const std::string& problem) {
      const bool is_default = &type == &model.types.front();
      document.report((is_default ? "" : "vehicle_types/" + type.name + "/") + problem);
    };
    if (!type.vehicle.design) {
      report("closed_loop: given: must be plant and controller: " + who + " are sent the control inputs of others");
    } else if (type.vehicle.design->plant.integrators() < 2) {
      report("plant: no double integrator: must have two poles at z = 1 (s = 0), as " + who +
             " are sent its input, an acceleration");
    }
  }
  if (document.problems() > before) return;
  for (VehicleType& type : model.types) {
    type.vehicle.design->sends_input = true;
    type.vehicle.loop = close_loop(*type.vehicle.design, type.vehicle.headway);
  }
}

}  // namespace platoon
