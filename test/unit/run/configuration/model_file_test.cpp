#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "unit/paper_platoon.hpp"
#include "unit/run/configuration/model_text.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

using Problems = std::vector<std::string>;

PlatoonModel parse(const std::string& text) {
  return parse_model(YAML::Load(text));
}

Problems problems_in(const std::string& text) {
  return problems_of([&text] { parse(text); });
}

Problems problems_when(const std::string& part, const std::string& other) {
  return problems_in(model_text_with(part, other));
}

void expect_same_bits(const StateSpace& found, const StateSpace& expected) {
  EXPECT_EQ(found.a(), expected.a());
  EXPECT_EQ(found.b(), expected.b());
  EXPECT_EQ(found.c(), expected.c());
}

bool any_begins_with(const Problems& problems, const std::string& start) {
  return std::any_of(problems.begin(), problems.end(),
                     [&start](const std::string& problem) { return problem.find(start) == 0; });
}

TEST(ModelFile, LoadsEveryShippedFile) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PLATOON_SOURCE_DIR "/config")) {
    if (entry.path().extension() != ".yaml") continue;
    ++files;
    EXPECT_EQ(problems_of([&entry] { parse_model(load_yaml(entry.path().string())); }), Problems{}) << entry.path();
  }
  EXPECT_GE(files, 1);
}

TEST(ModelFile, OfThePaperIsThePapersExample) {
  const PlatoonModel model = parse_model(load_yaml(PLATOON_SOURCE_DIR "/config/paper.yaml"));
  const PlatoonModel expected = paper_platoon();
  expect_same_bits(model.default_vehicle().loop.realization, expected.default_vehicle().loop.realization);
  EXPECT_EQ(model.default_vehicle().headway, 3.2);
  EXPECT_EQ(model.default_vehicle().standstill_distance, 0.0);
  EXPECT_EQ(model.sample_period, 0.1);
  EXPECT_EQ(model.default_vehicle().noise_variance, 0.6);
  EXPECT_EQ(model.leader.position(10), expected.leader.position(10));
  EXPECT_EQ(model.default_vehicle().initial_position.mean, 0.0);
  EXPECT_EQ(model.default_vehicle().initial_position.variance, 0.0);
  EXPECT_FALSE(model.allow_unstable);
}

TEST(ModelFile, SetsEveryQuantity) {
  std::string text = model_text_with("standstill_distance: 0.0", "standstill_distance: 6.5");
  const auto put = [&text](const std::string& part, const std::string& other) {
    text.replace(text.find(part), part.size(), other);
  };
  put("sample_period: 0.1", "sample_period: 0.02");
  put("noise_variance: 0.6", "noise_variance: 0.25");
  put("[{from_step: 0, value: 20.0}]", "[{from_step: 2, value: 10}, {from_step: 5, value: -4.5}]");
  put("{mean: 0.0, variance: 0.0}", "{mean: -0.5, variance: 0.09}");
  const PlatoonModel model = parse(text + "allow_unstable: true\n");
  EXPECT_EQ(model.default_vehicle().standstill_distance, 6.5);
  EXPECT_EQ(model.sample_period, 0.02);
  EXPECT_EQ(model.default_vehicle().noise_variance, 0.25);
  ASSERT_EQ(model.leader.changes().size(), 2u);
  EXPECT_EQ(model.leader.changes()[1].from_step, 5);
  EXPECT_EQ(model.leader.changes()[1].value, -4.5);
  EXPECT_NEAR(model.leader.position(6), 0.02 * (3 * 10 - 4.5), 1e-15);
  EXPECT_EQ(model.default_vehicle().initial_position.mean, -0.5);
  EXPECT_EQ(model.default_vehicle().initial_position.variance, 0.09);
  EXPECT_TRUE(model.allow_unstable);
}

TEST(ModelFile, DividesTheControllerByOnePlusHeadwayWhenAsked) {
  const PlatoonModel divided = parse(model_text_with("time_headway: 3.2", "time_headway: 2.4"));
  expect_same_bits(divided.default_vehicle().loop.realization, paper_platoon(2.4).default_vehicle().loop.realization);
  for (const char* not_asked : {"", ", divide_by_one_plus_headway: false"}) {
    const PlatoonModel model =
        parse(model_text_with("[1.35, 0.0], denominator: [1.0, 0.89], divide_by_one_plus_headway: true",
                              std::string("[0.32, 0.0], denominator: [1.0, 0.89]") + not_asked));
    EXPECT_DOUBLE_EQ(model.default_vehicle().loop.transfer.numerator()(0), 0.32);
  }
}

TEST(ModelFile, TakesNumbersInQuotes) {
  const PlatoonModel model = parse(
      "plant: {numerator: ['1.0'], denominator: ['1', '-2', '1']}\n"
      "controller: {numerator: ['1.35', '0'], denominator: ['1', '0.89'], divide_by_one_plus_headway: "
      "'true'}\n"
      "time_headway: '3.2'\nstandstill_distance: '0'\nsample_period: '0.1'\nnoise_variance: '0.6'\n"
      "leader: {speed: [{from_step: '0', value: '20'}]}\ninitial_position: {mean: '0', variance: '0'}\n");
  expect_same_bits(model.default_vehicle().loop.realization, paper_platoon().default_vehicle().loop.realization);
}

TEST(ModelFile, ClosedLoopFormEqualsPlantAndControllerForm) {
  const std::string loop =
      "plant: {numerator: [1.0], denominator: [1.0, -2.0, 1.0]}\n"
      "controller: {numerator: [1.35, 0.0], denominator: [1.0, 0.89], divide_by_one_plus_headway: true}\n";
  const PlatoonModel designed = parse(kModelText);
  const PlatoonModel given =
      parse(model_text_with(loop,
                            "closed_loop: {A: [[1.11, 1, 0], [-0.57, 0, 1], [0.13857142857142857, 0, 0]], "
                            "B: [0, 0.3214285714285714, 0], C: [1, 0, 0]}\n"));
  EXPECT_LT((given.default_vehicle().loop.realization.a() - designed.default_vehicle().loop.realization.a())
                .cwiseAbs()
                .maxCoeff(),
            1e-15);
  EXPECT_LT((given.default_vehicle().loop.realization.b() - designed.default_vehicle().loop.realization.b())
                .cwiseAbs()
                .maxCoeff(),
            1e-15);
  EXPECT_EQ(given.default_vehicle().loop.realization.c(), designed.default_vehicle().loop.realization.c());
  EXPECT_LT(
      (given.default_vehicle().loop.transfer.denominator() - designed.default_vehicle().loop.transfer.denominator())
          .norm(),
      1e-14);
  EXPECT_TRUE(designed.default_vehicle().design);
  EXPECT_FALSE(given.default_vehicle().design);
}

// All processes must read the same bits from the text that one of them writes.
TEST(ModelFile, IsTheSameToTheBitWhenWrittenAndReadAgain) {
  const std::string uneven = model_text_with("numerator: [1.0], denominator: [1.0, -2.0, 1.0]",
                                             "numerator: [0.7], denominator: [0.7, -1.4, 0.7]");
  const std::string closed =
      "closed_loop: {A: [[1.11, 1, 0], [-0.57, 0, 1], [0.13857142857142857, 0, 0]], "
      "B: [0, 0.3214285714285714, 0], C: [1, 0, 0]}\n" +
      kModelText.substr(kModelText.find("time_headway"));
  for (const std::string& text : {kModelText, uneven, closed, model_text_with("0.6", "0.1")}) {
    const PlatoonModel model = parse(text);
    const PlatoonModel again = parse(to_json(model).dump());
    expect_same_bits(again.default_vehicle().loop.realization, model.default_vehicle().loop.realization);
    EXPECT_EQ(again.default_vehicle().loop.transfer.denominator(), model.default_vehicle().loop.transfer.denominator());
    EXPECT_EQ(again.default_vehicle().noise_variance, model.default_vehicle().noise_variance);
    EXPECT_EQ(to_json(again), to_json(model));
  }
}

TEST(ModelFile, NamesTheQuantityThatIsOutOfRange) {
  const std::string positive = ": must be a finite number > 0", not_negative = ": must be a finite number >= 0";
  const std::string number = ": must be a finite number";
  EXPECT_EQ(problems_when("time_headway: 3.2", "time_headway: 0"), Problems{"time_headway: 0" + positive});
  EXPECT_EQ(problems_when("time_headway: 3.2", "time_headway: -3.2"), Problems{"time_headway: -3.2" + positive});
  EXPECT_EQ(problems_when("standstill_distance: 0.0", "standstill_distance: -1"),
            Problems{"standstill_distance: -1" + not_negative});
  EXPECT_EQ(problems_when("sample_period: 0.1", "sample_period: 0"),
            Problems{"sample_period: 0: must be a finite number >= 1e-9"});
  EXPECT_EQ(problems_when("noise_variance: 0.6", "noise_variance: -0.6"),
            Problems{"noise_variance: -0.6" + not_negative});
  EXPECT_EQ(problems_when("variance: 0.0}", "variance: -1e-9}"),
            Problems{"initial_position/variance: -1e-9" + not_negative});
  EXPECT_EQ(problems_when("mean: 0.0", "mean: left"), Problems{"initial_position/mean: left" + number});
  EXPECT_EQ(problems_when("value: 20.0", "value: fast"), Problems{"leader/speed[0]/value: fast" + number});
  EXPECT_EQ(problems_when("from_step: 0", "from_step: -1"),
            Problems{"leader/speed[0]/from_step: -1: must be a whole number from 0 to 70368744177664"});
  EXPECT_EQ(problems_when("from_step: 0", "from_step: 0.5"),
            Problems{"leader/speed[0]/from_step: 0.5: must be a whole number from 0 to 70368744177664"});
}

TEST(ModelFile, RejectsWhatIsNotFinite) {
  for (const char* bad : {".nan", ".inf", "-.inf", "nan", "inf"}) {
    EXPECT_EQ(problems_when("time_headway: 3.2", std::string("time_headway: ") + bad),
              Problems{std::string("time_headway: ") + bad + ": must be a finite number > 0"});
    EXPECT_EQ(problems_when("noise_variance: 0.6", std::string("noise_variance: ") + bad),
              Problems{std::string("noise_variance: ") + bad + ": must be a finite number >= 0"});
    EXPECT_EQ(problems_when("[1.0, 0.89]", std::string("[1.0, ") + bad + "]"),
              Problems{std::string("controller/denominator: [1.0, ") + bad + "]: must be a list of finite numbers"});
  }
}

TEST(ModelFile, NamesTheKeyOfAWrongType) {
  EXPECT_EQ(problems_when("time_headway: 3.2", "time_headway: [3.2]"),
            Problems{"time_headway: [3.2]: must be a finite number > 0"});
  EXPECT_EQ(problems_when("{mean: 0.0, variance: 0.0}", "0"),
            Problems{"initial_position: 0: must be a mapping of keys"});
  EXPECT_EQ(problems_when("{speed: [{from_step: 0, value: 20.0}]}", "{speed: 20}"),
            Problems{"leader/speed: 20: must be a list of mappings"});
  EXPECT_EQ(problems_when("numerator: [1.0]", "numerator: 1.0"),
            Problems{"plant/numerator: 1.0: must be a list of finite numbers"});
  EXPECT_EQ(problems_when("numerator: [1.0]", "numerator: []"),
            Problems{"plant/numerator: []: must be a list of finite numbers"});
  EXPECT_EQ(problems_when("divide_by_one_plus_headway: true", "divide_by_one_plus_headway: 1"),
            Problems{"controller/divide_by_one_plus_headway: 1: must be true or false"});
  EXPECT_EQ(problems_in(kModelText + "allow_unstable: perhaps\n"),
            Problems{"allow_unstable: perhaps: must be true or false"});
}

TEST(ModelFile, NamesEveryKeyThatIsMissing) {
  const Problems problems = problems_in(
      "plant: {numerator: [1.0]}\ncontroller: {denominator: [1.0]}\nleader: {}\n"
      "initial_position: {}\n");
  for (const char* key :
       {"plant/denominator", "controller/numerator", "time_headway", "standstill_distance", "sample_period",
        "noise_variance", "leader/speed", "initial_position/mean", "initial_position/variance"}) {
    EXPECT_TRUE(any_begins_with(problems, std::string(key) + ": missing: must be ")) << key;
  }
  EXPECT_EQ(problems.size(), 9u);
}

TEST(ModelFile, NamesEveryUnknownKey) {
  const Problems problems = problems_in(
      "plant: {numerator: [1.0], denominator: [1.0, -2.0, 1.0], gain: 2}\n"
      "controller: {numerator: [1.35, 0.0], denominator: [1.0, 0.89], divide_by_one_plus_headway: true, a: "
      "1}\n"
      "time_headway: 3.2\nstandstill_distance: 0.0\nsample_period: 0.1\nnoise_variance: 0.6\nheadway: 3.2\n"
      "leader: {speed: [{from_step: 0, value: 20.0, until: 3}], name: x}\n"
      "initial_position: {mean: 0.0, variance: 0.0, deviation: 1}\n");
  for (const char* key : {"plant/gain", "controller/a", "headway", "leader/speed[0]/until", "leader/name",
                          "initial_position/deviation"}) {
    EXPECT_TRUE(any_begins_with(problems, std::string(key) + ": unknown key: allowed are ")) << key;
  }
  EXPECT_EQ(problems.size(), 6u);
}

TEST(ModelFile, ReportsAllErrorsAtOnce) {
  const Problems problems = problems_in(
      "plant: {numerator: [1.0], denominator: [0, 0]}\n"
      "controller: {numerator: [x], denominator: [1.0, 0.89]}\n"
      "time_headway: -1\nstandstill_distance: -2\nsample_period: -3\nnoise_variance: -4\ncolour: red\n"
      "leader: {speed: [{from_step: 0, value: inf}]}\n"
      "initial_position: {mean: nan, variance: -5}\n");
  for (const char* key : {"plant/denominator: all zero: must be a polynomial other than 0", "controller/numerator",
                          "time_headway", "standstill_distance", "sample_period", "noise_variance", "colour",
                          "leader/speed[0]/value", "initial_position/mean", "initial_position/variance"}) {
    EXPECT_TRUE(any_begins_with(problems, key)) << key;
  }
  EXPECT_EQ(problems.size(), 10u);
}

// An error must not cause false errors.
TEST(ModelFile, ReportsNothingThatOnlyFollowsFromAnotherError) {
  EXPECT_EQ(problems_in("hello").size(), 1u);
  EXPECT_EQ(problems_when("[{from_step: 0, value: 20.0}]", "[{from_step: x, value: 20.0}, {from_step: 0, value: 1}]"),
            Problems{"leader/speed[0]/from_step: x: must be a whole number from 0 to 70368744177664"});
}

TEST(ModelFile, RejectsASpeedOfNothing) {
  const Problems problems = problems_when("[{from_step: 0, value: 20.0}]", "[~]");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].find("leader/speed[0]"), 0u);
}

TEST(ModelFile, NamesTheStepThatIsOutOfOrder) {
  const Problems problems =
      problems_when("[{from_step: 0, value: 20.0}]", "[{from_step: 5, value: 20.0}, {from_step: 5, value: 10.0}]");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].find("leader/speed"), 0u);
  EXPECT_NE(problems[0].find("from_step: 5: must be >= 0 and increase from one entry to the next"), std::string::npos);
}

TEST(ModelFile, RejectsALoopThatIsNotAdmissible) {
  const auto only = [](const Problems& problems, const std::string& part) {
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_NE(problems[0].find(part), std::string::npos) << problems[0];
  };
  only(problems_when("[1.35, 0.0]", "[1.35, 0.0, 0.0, 0.0]"), "T must be strictly proper");
  only(problems_when("[1.0, -2.0, 1.0]", "[1.0, -1.5, 0.5]"), "no double integral action");
  only(problems_when("[1.35, 0.0]", "[13.5, 0.0]"), "the closed loop is unstable: rho(A) = ");
  EXPECT_EQ(problems_in(model_text_with("[1.35, 0.0]", "[13.5, 0.0]") + "allow_unstable: true\n"), Problems{});
  EXPECT_EQ(problems_in(model_text_with("[1.35, 0.0]", "[13.5, 0.0]") + "allow_unstable: false\n").size(), 1u);
}

TEST(ModelFile, RejectsAClosedLoopThatIsNone) {
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
  EXPECT_TRUE(any_begins_with(both, "plant: given: must be absent beside closed_loop"));
  EXPECT_TRUE(any_begins_with(both, "controller: given: must be absent beside closed_loop"));
}

TEST(LoadYaml, NamesTheFileThatIsMissing) {
  EXPECT_EQ(
      problems_of([] { load_yaml("/no/such/model.yaml"); }),
      Problems{
          "model: /no/such/model.yaml: must be a file of at most 256 MB that can be read (No such file or directory)"});
}

TEST(LoadYaml, NamesTheFileThatIsNotYaml) {
  const TemporaryFolder folder;
  const std::string file = folder.file("model.yaml", "plant: [1, 2");
  const Problems problems = problems_of([&file] { load_yaml(file); });
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].find("model: " + file + ": must be YAML: "), 0u);
}

TEST(LoadYaml, NamesTheFolderThatStandsInTheFilesPlace) {
  const TemporaryFolder folder;
  try {
    load_yaml(folder.path());
    FAIL() << "a folder is no model file";
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(std::string(error.what()).find("model: " + folder.path() + ": must be "), 0u) << error.what();
  }
}

const char* const kLinkText =
    "channel: {noise_filter: {numerator: [1.0, 0.3], denominator: [1.0, -0.5, 0.1]}, quantisation_step: 0.5, "
    "delay: 2,\n"
    "          loss: {probability: 0.2, mean_burst: 2.5, on_loss: extrapolate}}\n"
    "vehicle_types:\n"
    "  truck: {time_headway: 4.0, standstill_distance: 5.0, channel: {delay: 1, loss: {probability: 0.1}}}\n"
    "  bus: {noise_variance: 0.1, initial_position: {mean: 1.0, variance: 2.0},\n"
    "        controller: {numerator: [1.3, 0.0], denominator: [1.0, 0.89], divide_by_one_plus_headway: "
    "true}}\n"
    "string: [default, truck, default, bus]\n";

TEST(ModelFile, SetsLinksAndTypesThatInheritWhatTheyDoNotGive) {
  const PlatoonModel model = parse(kModelText + kLinkText);
  EXPECT_EQ(model.default_vehicle().link.noise_filter.numerator(), Eigen::Vector2d(1.0, 0.3));
  EXPECT_EQ(model.default_vehicle().link.quantisation_step, 0.5);
  EXPECT_EQ(model.default_vehicle().link.delay, 2);
  ASSERT_TRUE(model.default_vehicle().link.loss);
  EXPECT_EQ(model.default_vehicle().link.loss->probability, 0.2);
  EXPECT_EQ(model.default_vehicle().link.loss->mean_burst, 2.5);
  EXPECT_EQ(model.default_vehicle().link.loss->predictor, (std::vector<double>{2.0, -1.0}));
  ASSERT_EQ(model.types.size(), 3u);
  const VehicleModel &bus = model.types[1].vehicle, &truck = model.types[2].vehicle;
  EXPECT_EQ(truck.headway, 4.0);
  expect_same_bits(truck.loop.realization, paper_platoon(4.0).default_vehicle().loop.realization);
  EXPECT_EQ(truck.standstill_distance, 5.0);
  EXPECT_EQ(truck.noise_variance, 0.6);
  EXPECT_EQ(truck.link.delay, 1);
  EXPECT_EQ(truck.link.quantisation_step, 0.5);
  EXPECT_EQ(truck.link.loss->probability, 0.1);
  EXPECT_EQ(truck.link.loss->predictor, (std::vector<double>{2.0, -1.0}));
  EXPECT_EQ(bus.headway, 3.2);
  EXPECT_EQ(bus.noise_variance, 0.1);
  EXPECT_EQ(bus.initial_position.variance, 2.0);
  EXPECT_NE(bus.loop.realization.b(), model.default_vehicle().loop.realization.b());
  EXPECT_TRUE(bus.link == model.default_vehicle().link);
  for (const VehicleType& type : model.types) EXPECT_TRUE(type.inherited.mean_burst) << type.name;
  EXPECT_FALSE(model.types[2].inherited.loss_probability);
  EXPECT_EQ(with_mean_burst(model, 3.0).types[2].vehicle.link.loss->mean_burst, 3.0);
  EXPECT_EQ(model.string, (std::vector<std::size_t>{0, 2, 0, 1}));
  EXPECT_FALSE(is_homogeneous(model));
  for (const std::size_t i : {2, 6}) EXPECT_EQ(vehicle(model, i).headway, 4.0);
  EXPECT_EQ(place_in_formation(model, 7), -10.0);
}

TEST(ModelFile, AnInheritedMeanBurstStaysInheritedInEveryCopy) {
  nlohmann::json document = to_json(parse(kModelText + kLinkText));
  document["channel"]["loss"]["mean_burst"] = 1.5;
  for (const VehicleType& type : parse(document.dump()).types) EXPECT_EQ(type.vehicle.link.loss->mean_burst, 1.5);
}

TEST(ModelFile, SetsATypeByItsOwnClosedLoop) {
  const PlatoonModel model =
      parse(kModelText +
            "vehicle_types: {twin: {closed_loop: {A: [[1.11, 1, 0], [-0.57, 0, 1], [0.13857142857142857, 0, 0]], "
            "B: [0, 0.3214285714285714, 0], C: [1, 0, 0]}}}\nstring: [twin]\n");
  EXPECT_LT(
      (vehicle(model, 1).loop.realization.a() - model.default_vehicle().loop.realization.a()).cwiseAbs().maxCoeff(),
      1e-15);
  EXPECT_FALSE(vehicle(model, 1).design);
  EXPECT_TRUE(vehicle(model, 0).design);
  // A, B, C hold for one headway: another headway needs other matrices.
  const Problems problems =
      problems_in(kModelText +
                  "vehicle_types: {twin: {time_headway: 4, closed_loop: {A: [[1.11, 1, 0], [-0.57, 0, 1], "
                  "[0.13857142857142857, 0, "
                  "0]], B: [0, 0.3214285714285714, 0], C: [1, 0, 0]}}}\nstring: [twin]\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].find("vehicle_types/twin: no double integral action"), 0u) << problems[0];
}

TEST(ModelFile, OfLinksAndTypesIsTheSameWhenWrittenAndReadAgain) {
  const PlatoonModel model = parse(kModelText + kLinkText);
  const PlatoonModel again = parse(to_json(model).dump());
  EXPECT_EQ(to_json(again), to_json(model));
  EXPECT_TRUE(again.default_vehicle().link == model.default_vehicle().link);
  EXPECT_EQ(again.string, model.string);
  for (std::size_t i = 0; i < model.types.size(); ++i) {
    EXPECT_TRUE(again.types[i].vehicle.link == model.types[i].vehicle.link);
    expect_same_bits(again.types[i].vehicle.loop.realization, model.types[i].vehicle.loop.realization);
  }
}

TEST(ModelFile, WithoutLinksAndTypesIsWrittenAsBefore) {
  const nlohmann::json document = to_json(parse(kModelText));
  for (const char* key : {"channel", "vehicle_types", "string"}) EXPECT_FALSE(document.contains(key)) << key;
  EXPECT_TRUE(is_papers(parse(kModelText)));
  EXPECT_TRUE(is_papers(parse(kModelText + "channel: {delay: 0, loss: {probability: 0}}\nstring: [default]\n")));
  EXPECT_FALSE(is_papers(parse(kModelText + "channel: {delay: 1}\n")));
}

TEST(ModelFile, NamesWhatIsWrongWithALink) {
  const auto problems_of_link = [](const std::string& text) {
    return problems_in(kModelText + "channel: {" + text + "}\n");
  };
  EXPECT_EQ(problems_of_link("loss: {probability: 1.0}"),
            Problems{"channel/loss/probability: 1.0: must be a number from 0 to below 1"});
  EXPECT_EQ(problems_of_link("loss: {probability: -0.1}"),
            Problems{"channel/loss/probability: -0.1: must be a number from 0 to below 1"});
  EXPECT_EQ(problems_of_link("loss: {on_loss: hold}"),
            Problems{"channel/loss/probability: missing: must be a number from 0 to below 1"});
  EXPECT_EQ(problems_of_link("loss: {probability: 0.9, mean_burst: 8}"),
            Problems{"channel/loss/mean_burst: 8: must be at least 9, the larger of 1 and q / (1 - q) for q "
                     "= 0.9: no chain "
                     "has shorter bursts; independent losses have 1 / (1 - q) = 10"});
  EXPECT_EQ(problems_of_link("loss: {probability: 0.2, mean_burst: 0.9}").front().substr(0, 48),
            "channel/loss/mean_burst: 0.9: must be at least 1");
  EXPECT_EQ(problems_of_link("noise_filter: {numerator: [1, 0, 0], denominator: [1, 0.5]}"),
            Problems{"channel/noise_filter: more zeros than poles: must be proper: no more zeros than poles"});
  EXPECT_EQ(problems_of_link("noise_filter: {numerator: [1], denominator: [1, -1]}"),
            Problems{"channel/noise_filter: a pole of modulus 1: must be stable: poles inside the unit circle"});
  EXPECT_EQ(problems_of_link("delay: -1"), Problems{"channel/delay: -1: must be a whole number from 0 to 10000"});
  EXPECT_EQ(problems_of_link("quantisation_step: -1"),
            Problems{"channel/quantisation_step: -1: must be a finite number >= 0"});
  EXPECT_EQ(problems_of_link("loss: {probability: 0.1, on_loss: [1, 0.5]}"),
            Problems{"channel/loss/on_loss: coefficients of sum 1.5: must be of sum 1, as a platoon moves: "
                     "[1] holds, [2, "
                     "-1] extrapolates"});
  EXPECT_EQ(problems_of_link("loss: {probability: 0.1, on_loss: stop}"),
            Problems{"channel/loss/on_loss: stop: must be hold or extrapolate or a list of coefficients of sum 1"});
  EXPECT_EQ(problems_of_link("jitter: 1"),
            Problems{"channel/jitter: unknown key: allowed are delay, loss, noise_filter, quantisation_step"});
}

TEST(ModelFile, RunsPredictionsThatGrowOnlyIfAskedTo) {
  const std::string growing = kModelText + "channel: {loss: {probability: 0.5, on_loss: [2.5, -1.5]}}\n";
  const Problems problems = problems_in(growing);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].find("channel/loss/on_loss: predictions whose p q ||L F||^2 is 3.66667: must be one"), 0u)
      << problems[0];
  EXPECT_EQ(problems_in(growing + "allow_unstable: true\n"), Problems{});
}

TEST(ModelFile, NamesWhatIsWrongWithTypesAndStrings) {
  const Problems problems =
      problems_in(kModelText +
                  "vehicle_types: {truck: {sample_period: 0.2, leader: {speed: []}, time_headway: -1}, default: {}, "
                  "car: {weight: 1}}\nstring: [default, lorry]\n");
  for (const char* key :
       {"vehicle_types/truck/sample_period: given: must be absent, as all vehicles share it",
        "vehicle_types/truck/leader: given: must be absent, as all vehicles share it",
        "vehicle_types/truck/time_headway: -1: must be a finite number > 0",
        "vehicle_types/default: given: must be of another name", "vehicle_types/car/weight: unknown key: allowed are ",
        "string[1]: lorry: must be one of the vehicle types default, car, truck"}) {
    EXPECT_TRUE(any_begins_with(problems, key)) << key;
  }
  EXPECT_EQ(problems.size(), 6u);
  EXPECT_EQ(problems_in(kModelText + "string: []\n"), Problems{"string: []: must be a list of names, not empty"});
  const Problems unstable =
      problems_in(kModelText + "vehicle_types: {slow: {plant: {numerator: [1], denominator: [1, -1]}}}\n");
  ASSERT_FALSE(unstable.empty());
  EXPECT_EQ(unstable[0].find("vehicle_types/slow: no double integral action"), 0u) << unstable[0];
}

}  // namespace
}  // namespace platoon
