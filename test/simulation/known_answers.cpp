// Functions of their argument alone, which a real process computes once and a simulated world many times: the
// configuration of a text, its prediction, and the stable headways of a model. Most of the time would go into them. The
// linker (--wrap) leads calls here, and each argument is computed once.

#include <map>
#include <mutex>
#include <string>

#include "simulation/launches.hpp"
#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"

namespace platoon::simulation {

Configuration computed_configuration(const std::string& text) asm("__real_" PLATOON_PARSE);
Configuration known_configuration(const std::string& text) asm("__wrap_" PLATOON_PARSE);
Prediction computed_prediction(const Configuration& configuration) asm("__real_" PLATOON_PREDICT);
Prediction known_prediction(const Configuration& configuration) asm("__wrap_" PLATOON_PREDICT);
using Headways = std::optional<StableHeadways>;
Headways computed_headways(const PlatoonModel& model) asm("__real_" PLATOON_HEADWAYS);
Headways known_headways(const PlatoonModel& model) asm("__wrap_" PLATOON_HEADWAYS);

Configuration known_configuration(const std::string& text) {
  constexpr std::size_t kMost = 100;  // more than the texts of one run, which no other run has
  static std::map<std::string, Configuration> known;
  const auto found = known.find(text);
  if (found != known.end()) return found->second;
  if (known.size() >= kMost) known.clear();
  return known.emplace(text, computed_configuration(text)).first->second;
}

Prediction known_prediction(const Configuration& configuration) {
  static std::map<std::string, Prediction> known;
  Configuration asked = of_any_launch(configuration);
  const RunOptions any{};
  asked.run.seed = any.seed;
  asked.run.realizations = any.realizations;
  asked.run.batch = any.batch;
  asked.run.window = any.window;
  asked.run.rate = any.rate;
  asked.run.stall_timeout = any.stall_timeout;
  asked.run.number = any.number;
  const std::string key = to_json(asked).dump();
  const auto found = known.find(key);
  return found != known.end() ? found->second : known.emplace(key, computed_prediction(configuration)).first->second;
}

// Nodes ask for them in threads of their own.
Headways known_headways(const PlatoonModel& model) {
  static std::mutex mutex;
  static std::map<std::string, Headways> known;
  const std::lock_guard<std::mutex> lock(mutex);
  const std::string key = to_json(model).dump();
  const auto found = known.find(key);
  return found != known.end() ? found->second : known.emplace(key, computed_headways(model)).first->second;
}

}  // namespace platoon::simulation
