// Each value of a model file, on its own, replaced by values of every kind: a model, or an error that names its key.

#include <gtest/gtest.h>

#include <map>

#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "unit/run/configuration/model_text.hpp"

namespace platoon {
namespace {

const std::vector<std::string> kOddValues{"~",    "x",  "true", "-1",    "0",        "3",  "1e-320",
                                          ".nan", "[]", "[1]",  "[[1]]", "[{a: 1}]", "{}", "{a: 1}"};

// Without it, every document computes how many steps its model needs.
const std::map<std::string, std::string> kSteps{{"steps", "9"}};
// Settings that lead to keys of the model, in vain where an odd value has another structure.
const std::map<std::string, std::string> kOverrides{{"steps", "9"}, {"loss", "0.1"},         {"mean_burst", "2"},
                                                    {"delay", "2"}, {"noise_variance", "1"}, {"headway", "35"}};

const std::string kHearing =
    kCarText +
    "start: steady\n"
    "safe_gap: 1.0\n"
    "own_acceleration: -0.1\n"
    "limits: {input: [-6, 2.5], speed: [0, 40]}\n"
    "channel: {delay: 1, quantisation_step: 0.1, loss: {probability: 0.1, on_loss: extrapolate}}\n"
    "noise_variance: 0.01\n"
    "inputs:\n"
    "  - {signal: position, weight: 0.6}\n"
    "  - {signal: position, from: 2, weight: 0.4, noise_variance: 0.05, channel: {noise_filter: "
    "{numerator: [1, 0.5], denominator: [1, -0.5]}}}\n"
    "  - {signal: speed, from: predecessor, gain: 0.2, noise_variance: 0.04, channel: {packet: radio, loss: "
    "{markov: {transition: [[0.9, 0.1], [0.3, 0.7]], probability: [0.02, 0.7]}, on_loss: zero}}}\n"
    "  - {signal: input, from: predecessor, gain: 0.2, noise_variance: 0.1, channel: {packet: radio, delay: 1}}\n"
    "vehicle_types:\n"
    "  truck:\n"
    "    plant: {continuous: {numerator: [1], denominator: [0.3, 1, 0, 0], input_delay: 0.1}}\n"
    "    time_headway_seconds: 4\n"
    "    vehicle_length: 4.5\n"
    "    inputs:\n"
    "      - {signal: position, noise_variance: 0.1, channel: {loss: {runs: 5 2 7 1, on_loss: [1.2, -0.2]}}}\n"
    "string: [default, truck]\n";
const std::string kSampled =
    kModelText + "allow_unstable: true\nchannel: {loss: {by_distance: [[0, 0], [50, 0.2]], on_loss: hold}}\n";
const std::string kClosed = kClosedLoopText + kModelText.substr(kModelText.find("\ntime_headway")) +
                            "channel: {loss: {probability: 0.1, mean_burst: 3}}\n";

class OddValue {
public:
  explicit OddValue(const std::string& text) : model_(YAML::Load(text)) {
    read(kSteps, "the whole model");
    EXPECT_EQ(accepted, 1);
    replace_within(model_, "");
  }

  int accepted = 0, rejected = 0;

private:
  void replace_within(const YAML::Node& node, const std::string& path) {
    for (std::size_t i = 0; node.IsSequence() && i < node.size(); ++i) replace(node, i, path + "/" + std::to_string(i));
    if (!node.IsMap()) return;
    std::vector<std::string> keys;
    for (const auto& entry : node) keys.push_back(entry.first.Scalar());
    for (const std::string& key : keys) replace(node, key, path + "/" + key);
  }

  template <typename Key>
  void replace(YAML::Node parent, const Key& key, const std::string& path) {
    replace_within(parent[key], path);
    const YAML::Node value = YAML::Clone(parent[key]);
    for (const std::string& odd : kOddValues) {
      parent[key] = YAML::Load(odd);
      read(kSteps, path + ": " + odd);
      if (odd.find_first_of("~[{") != std::string::npos) read(kOverrides, path + ": " + odd);
    }
    parent[key] = value;
  }

  void read(const std::map<std::string, std::string>& overrides, const std::string& what) {
    SCOPED_TRACE(what);
    Problems problems;
    try {
      YAML::Node model = YAML::Clone(model_);
      resolve_tables(model, "/");
      problems = problems_of([&] { parse_configuration(configuration_document(model, overrides)); });
    } catch (const std::exception& error) {
      ADD_FAILURE() << "not an error of the configuration: " << error.what();
    }
    ++(problems.empty() ? accepted : rejected);
    for (const std::string& problem : problems)
      EXPECT_TRUE(problem.rfind("model", 0) == 0 || problem.rfind("run/", 0) == 0) << problem;
  }

  YAML::Node model_;
};

TEST(OddValues, GiveAModelOrAnErrorOfTheirKey) {
  for (const std::string& text : {kHearing, kSampled, kClosed}) {
    SCOPED_TRACE(text.substr(0, 30));
    const OddValue odd(text);
    EXPECT_GT(odd.accepted, 20);
    EXPECT_GT(odd.rejected, 500);
  }
}

}  // namespace
}  // namespace platoon
