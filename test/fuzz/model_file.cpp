// Reads any bytes as a model file: gives a model or a ConfigurationError. Writing and reading keep a model unchanged.

#include <cstdlib>
#include <string>

#include "fuzz/fuzz.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string file = platoon::fuzz::file_of(data, size);
  try {
    const platoon::PlatoonModel model = platoon::parse_model(platoon::load_yaml(file));
    const std::string written = platoon::to_json(model).dump();
    const platoon::PlatoonModel again = platoon::parse_model(YAML::Load(written));
    if (platoon::to_json(again).dump() != written) std::abort();
  } catch (const platoon::ConfigurationError&) {
  }
  return 0;
}
