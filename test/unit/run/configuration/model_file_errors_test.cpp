// The problems that parse_model() reports.

#include <gtest/gtest.h>

#include "unit/run/configuration/model_text.hpp"

namespace platoon {
namespace {

Problems problems_when(const std::string& part, const std::string& other) {
  return problems_in(model_text_with(part, other));
}

/// Whether there is one problem per key, which begins with the key and `end`.
void expect_one_each(const Problems& problems, const std::vector<std::string>& keys, const std::string& end) {
  for (const std::string& key : keys) EXPECT_TRUE(is_among(problems, key + end));
  EXPECT_EQ(problems.size(), keys.size());
}

TEST(ModelFileErrors, NameAQuantityThatIsOutOfRange) {
  expect_problems(
      kModelText,
      {{"time_headway: 3.2", "time_headway: 0", "time_headway: 0: must be a finite number > 0"},
       {"time_headway: 3.2", "time_headway: -3.2", "time_headway: -3.2: must be a finite number > 0"},
       {"distance: 0.0", "distance: -1", "standstill_distance: -1: must be a finite number >= 0"},
       {"sample_period: 0.1", "sample_period: 0", "sample_period: 0: must be a finite number >= 1e-9"},
       {"noise_variance: 0.6", "noise_variance: -0.6", "noise_variance: -0.6: must be a finite number >= 0"},
       {"variance: 0.0}", "variance: -1e-9}", "initial_position/variance: -1e-9: must be a finite number >= 0"},
       {"from_step: 0", "from_step: -1",
        "leader/speed[0]/from_step: -1: must be a whole number from 0 to 70368744177664"},
       {"from_step: 0", "from_step: 0.5",
        "leader/speed[0]/from_step: 0.5: must be a whole number from 0 to 70368744177664"}});
}

TEST(ModelFileErrors, NameANumberThatIsNotFinite) {
  for (const std::string bad : {".nan", ".inf", "-.inf", "nan", "inf"}) {
    EXPECT_EQ(problems_when("time_headway: 3.2", "time_headway: " + bad),
              Problems{"time_headway: " + bad + ": must be a finite number > 0"});
    EXPECT_EQ(problems_when("noise_variance: 0.6", "noise_variance: " + bad),
              Problems{"noise_variance: " + bad + ": must be a finite number >= 0"});
    EXPECT_EQ(problems_when("[1.0, 0.89]", "[1.0, " + bad + "]"),
              Problems{"controller/denominator: [1.0, " + bad + "]: must be a list of finite numbers"});
  }
}

TEST(ModelFileErrors, NameAKeyOfAWrongType) {
  expect_problems(
      kModelText + "allow_unstable: true\n",
      {{"time_headway: 3.2", "time_headway: [3.2]", "time_headway: [3.2]: must be a finite number > 0"},
       {"mean: 0.0", "mean: left", "initial_position/mean: left: must be a finite number"},
       {"value: 20.0", "value: fast", "leader/speed[0]/value: fast: must be a finite number"},
       {"{mean: 0.0, variance: 0.0}", "0", "initial_position: 0: must be a mapping of keys"},
       {"{speed: [{from_step: 0, value: 20.0}]}", "{speed: 20}", "leader/speed: 20: must be a list of mappings"},
       {"[{from_step: 0, value: 20.0}]", "[~]", "leader/speed[0]"},
       {"numerator: [1.0]", "numerator: 1.0", "plant/numerator: 1.0: must be a list of finite numbers"},
       {"numerator: [1.0]", "numerator: []", "plant/numerator: []: must be a list of finite numbers"},
       {"headway: true", "headway: 1", "controller/divide_by_one_plus_headway: 1: must be true or false"},
       {"unstable: true", "unstable: perhaps", "allow_unstable: perhaps: must be true or false"}});
}

TEST(ModelFileErrors, NameEveryMissingKey) {
  const Problems problems =
      problems_in("plant: {numerator: [1.0]}\ncontroller: {denominator: [1.0]}\nleader: {}\ninitial_position: {}\n");
  expect_one_each(problems,
                  {"plant/denominator", "controller/numerator", "time_headway", "standstill_distance", "sample_period",
                   "noise_variance", "leader/speed", "initial_position/mean", "initial_position/variance"},
                  ": missing: must be ");
}

TEST(ModelFileErrors, NameEveryUnknownKey) {
  const Problems problems = problems_in(
      "plant: {numerator: [1.0], denominator: [1.0, -2.0, 1.0], gain: 2}\n"
      "controller: {numerator: [1.35, 0.0], denominator: [1.0, 0.89], divide_by_one_plus_headway: true, a: 1}\n"
      "time_headway: 3.2\nstandstill_distance: 0.0\nsample_period: 0.1\nnoise_variance: 0.6\nheadway: 3.2\n"
      "leader: {speed: [{from_step: 0, value: 20.0, until: 3}], name: x}\n"
      "initial_position: {mean: 0.0, variance: 0.0, deviation: 1}\n");
  expect_one_each(
      problems,
      {"plant/gain", "controller/a", "headway", "leader/speed[0]/until", "leader/name", "initial_position/deviation"},
      ": unknown key: allowed are ");
}

TEST(ModelFileErrors, AreReportedAllAtOnce) {
  const Problems problems = problems_in(
      "plant: {numerator: [1.0], denominator: [0, 0]}\n"
      "controller: {numerator: [x], denominator: [1.0, 0.89]}\n"
      "time_headway: -1\nstandstill_distance: -2\nsample_period: -3\nnoise_variance: -4\ncolour: red\n"
      "leader: {speed: [{from_step: 0, value: inf}]}\n"
      "initial_position: {mean: nan, variance: -5}\n");
  expect_one_each(problems,
                  {"plant/denominator: all zero: must be a polynomial other than 0", "controller/numerator",
                   "time_headway", "standstill_distance", "sample_period", "noise_variance", "colour",
                   "leader/speed[0]/value", "initial_position/mean", "initial_position/variance"},
                  "");
}

TEST(ModelFileErrors, CauseNoFalseErrors) {
  EXPECT_EQ(problems_in("hello").size(), 1u);
  EXPECT_EQ(problems_when("[{from_step: 0, value: 20.0}]", "[{from_step: x, value: 20.0}, {from_step: 0, value: 1}]"),
            Problems{"leader/speed[0]/from_step: x: must be a whole number from 0 to 70368744177664"});
}

TEST(ModelFileErrors, NameAStepThatIsOutOfOrder) {
  const Problems problems =
      problems_when("[{from_step: 0, value: 20.0}]", "[{from_step: 5, value: 20.0}, {from_step: 5, value: 10.0}]");
  ASSERT_TRUE(is_problem(problems, "leader/speed"));
  EXPECT_TRUE(contains(problems[0], "from_step: 5: must be >= 0 and increase from one entry to the next"));
}

TEST(ModelFileErrors, NameALoopThatIsNotAdmissible) {
  const auto expect_only = [](const Problems& problems, const std::string& part) {
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_TRUE(contains(problems[0], part));
  };
  const std::string unstable = model_text_with("[1.35, 0.0]", "[13.5, 0.0]");
  expect_only(problems_when("[1.35, 0.0]", "[1.35, 0.0, 0.0, 0.0]"), "T must be strictly proper");
  expect_only(problems_when("[1.0, -2.0, 1.0]", "[1.0, -1.5, 0.5]"), "no double integral action");
  expect_only(problems_in(unstable), "the closed loop is unstable: rho(A) = ");
  EXPECT_EQ(problems_in(unstable + "allow_unstable: true\n"), Problems{});
  EXPECT_EQ(problems_in(unstable + "allow_unstable: false\n").size(), 1u);
}

TEST(ModelFileErrors, NameAnInvalidClosedLoop) {
  const std::string rest = kModelText.substr(kModelText.find("time_headway"));
  const auto with_loop = [&rest](const std::string& loop) { return problems_in("closed_loop: " + loop + "\n" + rest); };
  EXPECT_EQ(with_loop("{A: [[1, 2]], B: [1], C: [1]}"),
            Problems{"closed_loop/A: 1 x 2: must be square, n x n with n >= 1"});
  EXPECT_EQ(with_loop("{A: [[0.5]], B: [1, 2], C: [1]}"),
            Problems{"closed_loop/B: 2 x 1, C: 1 x 1: must be n x 1 and 1 x n with A's n = 1"});
  EXPECT_EQ(with_loop("{A: [[0.5], [1, 2]], B: [x]}"),
            (Problems{"closed_loop/A: [[0.5], [1, 2]]: must be a list of rows of finite numbers, all of one length",
                      "closed_loop/B: [x]: must be a list of finite numbers",
                      "closed_loop/C: missing: must be a list of finite numbers"}));
  EXPECT_EQ(with_loop("7"), Problems{"closed_loop: 7: must be a mapping of keys"});
  const Problems both = problems_in(kModelText + "closed_loop: {A: [[0.5]], B: [1], C: [1]}\n");
  EXPECT_TRUE(is_among(both, "plant: given: must be absent beside closed_loop"));
  EXPECT_TRUE(is_among(both, "controller: given: must be absent beside closed_loop"));
}

TEST(ModelFileErrors, NameAnInvalidChannel) {
  struct Case {
    const char *channel, *problem;
  };
  for (
      const auto& [channel, problem] : {
          Case{"loss: {probability: 1.0}", "loss/probability: 1.0: must be a number from 0 to below 1"},
          Case{"loss: {probability: -0.1}", "loss/probability: -0.1: must be a number from 0 to below 1"},
          Case{"loss: {on_loss: hold}", "loss/probability: missing: must be a number from 0 to below 1"},
          Case{"loss: {probability: 0.9, mean_burst: 8}",
               "loss/mean_burst: 8: must be at least 9, the larger of 1 and q / (1 - q) for q = 0.9: no chain has "
               "shorter bursts; independent losses have 1 / (1 - q) = 10"},
          Case{"loss: {probability: 0.2, mean_burst: 0.9}", "loss/mean_burst: 0.9: must be at least 1"},
          Case{"loss: {markov: {transition: [[0.9, 0.2], [0.3, 0.7]], probability: [0.0, 0.5]}}",
               "loss/markov/transition: row 1: a sum of 1.1: must be 1"},
          Case{"loss: {probability: 0.1, markov: {transition: [[1.0]], probability: [0.5]}}",
               "loss/probability: given: must be absent beside markov"},
          Case{"loss: {markov: {transition: [[1.0]]}}", "loss/markov/probability: missing"},
          Case{"loss: {markov: 3}", "loss/markov: 3: must be a mapping of keys"},
          Case{"loss: {probability: 0.2, mean_burst: 1.1e6}",
               "loss/mean_burst: 1.1e+06: must be at most 1000000 steps"},
          Case{"noise_filter: {numerator: [1, 0, 0], denominator: [1, 0.5]}",
               "noise_filter: more zeros than poles: must be proper: no more zeros than poles"},
          Case{"noise_filter: {numerator: [1], denominator: [1, -1]}",
               "noise_filter: a pole of modulus 1: must be stable: poles inside the unit circle"},
          Case{"delay: -1", "delay: -1: must be a whole number from 0 to 10000"},
          Case{"quantisation_step: -1", "quantisation_step: -1: must be a finite number >= 0"},
          Case{"loss: {probability: 0.1, on_loss: [1, 0.5]}",
               "loss/on_loss: weights of sum 1.5: must be of sum 1, as a platoon moves: [1] holds, [2, -1] "
               "extrapolates"},
          Case{
              "loss: {probability: 0.1, on_loss: stop}",
              "loss/on_loss: stop: must be hold or extrapolate or a list of weights of sum 1 for the last values used"},
          Case{"jitter: 1", "jitter: unknown key: allowed are delay, loss, noise_filter, quantisation_step"},
      }) {
    EXPECT_TRUE(
        is_problem(problems_in(kModelText + "channel: {" + channel + "}\n"), std::string("channel/") + problem));
  }
}

TEST(ModelFileErrors, NamePredictionsThatGrowUnlessTheyAreAllowed) {
  const std::string growing = kModelText + "channel: {loss: {probability: 0.5, on_loss: [2.5, -1.5]}}\n";
  EXPECT_TRUE(is_problem(problems_in(growing),
                         "channel/loss/on_loss: predictions whose p q ||L F||^2 is 3.66667: must be one"));
  EXPECT_EQ(problems_in(growing + "allow_unstable: true\n"), Problems{});
}

TEST(ModelFileErrors, NameInvalidTypesAndStrings) {
  const Problems problems =
      problems_in(kModelText +
                  "vehicle_types: {truck: {sample_period: 0.2, leader: {speed: []}, time_headway: -1}, default: {}, "
                  "car: {weight: 1}}\nstring: [default, lorry]\n");
  for (const char* start :
       {"vehicle_types/truck/sample_period: given: must be absent, as all vehicles share it",
        "vehicle_types/truck/leader: given: must be absent, as all vehicles share it",
        "vehicle_types/truck/time_headway: -1: must be a finite number > 0",
        "vehicle_types/default: given: must be of another name", "vehicle_types/car/weight: unknown key: allowed are ",
        "string[1]: lorry: must be one of the vehicle types default, car, truck"}) {
    EXPECT_TRUE(is_among(problems, start));
  }
  EXPECT_EQ(problems.size(), 6u);
  EXPECT_EQ(problems_in(kModelText + "string: []\n"), Problems{"string: []: must be a list of names, not empty"});
  EXPECT_TRUE(begins_with(
      problems_in(kModelText + "vehicle_types: {slow: {plant: {numerator: [1], denominator: [1, -1]}}}\n").at(0),
      "vehicle_types/slow: no double integral action"));
}

}  // namespace
}  // namespace platoon
