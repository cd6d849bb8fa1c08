#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "unit/messages.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/run/configuration/model_text.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

void expect_same_loop(const VehicleModel& found, const VehicleModel& expected) {
  EXPECT_EQ(found.loop.realization.a(), expected.loop.realization.a());
  EXPECT_EQ(found.loop.realization.b(), expected.loop.realization.b());
  EXPECT_EQ(found.loop.realization.c(), expected.loop.realization.c());
}

void expect_nearly_same_loop(const VehicleModel& found, const VehicleModel& expected) {
  const StateSpace &one = found.loop.realization, &other = expected.loop.realization;
  EXPECT_LT((one.a() - other.a()).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT((one.b() - other.b()).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(one.c(), other.c());
  EXPECT_LT((found.loop.transfer.denominator() - expected.loop.transfer.denominator()).norm(), 1e-14);
}

TEST(ModelFile, IsValidInEveryShippedFile) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PLATOON_SOURCE_DIR "/config")) {
    if (entry.path().extension() != ".yaml") continue;
    ++files;
    EXPECT_EQ(problems_of([&entry] { parse_model(load_yaml(entry.path().string())); }), Problems{}) << entry.path();
  }
  EXPECT_GE(files, 1);
}

TEST(ModelFile, MayAllowWhatGrows) {
  for (const std::string& growing : {model_text_with("[1.35, 0.0]", "[13.5, 0.0]"),
                                     kModelText + "channel: {loss: {probability: 0.5, on_loss: [2.5, -1.5]}}\n"}) {
    EXPECT_EQ(problems_in(growing + "allow_unstable: true\n"), Problems{});
    EXPECT_EQ(problems_in(growing + "allow_unstable: false\n").size(), 1u);
  }
}

TEST(ModelFile, DescribesThePapersExample) {
  const PlatoonModel model = parse_model(load_yaml(PLATOON_SOURCE_DIR "/config/paper.yaml"));
  const PlatoonModel expected = paper_platoon();
  expect_same_loop(model.default_vehicle(), expected.default_vehicle());
  EXPECT_EQ(model.default_vehicle().headway, 3.2);
  EXPECT_EQ(model.default_vehicle().standstill_distance, 0.0);
  EXPECT_EQ(model.sample_period, 0.1);
  EXPECT_EQ(model.default_vehicle().position().noise_variance, 0.6);
  EXPECT_EQ(model.leader.position(10), expected.leader.position(10));
  EXPECT_EQ(model.default_vehicle().initial_position.mean, 0.0);
  EXPECT_EQ(model.default_vehicle().initial_position.variance, 0.0);
  EXPECT_FALSE(model.allow_unstable);
}

TEST(ModelFile, SetsEveryQuantity) {
  std::string text = kModelText + "allow_unstable: true\n";
  for (const auto& [part, other] : std::vector<std::pair<std::string, std::string>>{
           {"standstill_distance: 0.0", "standstill_distance: 6.5"},
           {"sample_period: 0.1", "sample_period: 0.02"},
           {"noise_variance: 0.6", "noise_variance: 0.25"},
           {"[{from_step: 0, value: 20.0}]", "[{from_step: 2, value: 10}, {from_step: 5, value: -4.5}]"},
           {"{mean: 0.0, variance: 0.0}", "{mean: -0.5, variance: 0.09}"}}) {
    text = replaced(text, part, other);
  }
  const PlatoonModel model = model_of(text);
  EXPECT_EQ(model.default_vehicle().standstill_distance, 6.5);
  EXPECT_EQ(model.sample_period, 0.02);
  EXPECT_EQ(model.default_vehicle().position().noise_variance, 0.25);
  ASSERT_EQ(model.leader.changes().size(), 2u);
  EXPECT_EQ(model.leader.changes()[1].from_step, 5);
  EXPECT_EQ(model.leader.changes()[1].value, -4.5);
  EXPECT_NEAR(model.leader.position(6), 0.02 * (3 * 10 - 4.5), 1e-15);
  EXPECT_EQ(model.default_vehicle().initial_position.mean, -0.5);
  EXPECT_EQ(model.default_vehicle().initial_position.variance, 0.09);
  EXPECT_TRUE(model.allow_unstable);
}

TEST(ModelFile, DividesTheControllerByOnePlusHeadwayIfRequested) {
  const PlatoonModel divided = model_of(model_text_with("time_headway: 3.2", "time_headway: 2.4"));
  expect_same_loop(divided.default_vehicle(), paper_platoon(2.4).default_vehicle());
  for (const char* not_requested : {"", ", divide_by_one_plus_headway: false"}) {
    const PlatoonModel model =
        model_of(model_text_with("[1.35, 0.0], denominator: [1.0, 0.89], divide_by_one_plus_headway: true",
                                 std::string("[0.32, 0.0], denominator: [1.0, 0.89]") + not_requested));
    EXPECT_DOUBLE_EQ(model.default_vehicle().loop.transfer.numerator()(0), 0.32);
  }
}

TEST(ModelFile, MayHaveNumbersInQuotes) {
  const PlatoonModel model = model_of(
      "plant: {numerator: ['1.0'], denominator: ['1', '-2', '1']}\n"
      "controller: {numerator: ['1.35', '0'], denominator: ['1', '0.89'], divide_by_one_plus_headway: 'true'}\n"
      "time_headway: '3.2'\nstandstill_distance: '0'\nsample_period: '0.1'\nnoise_variance: '0.6'\n"
      "leader: {speed: [{from_step: '0', value: '20'}]}\ninitial_position: {mean: '0', variance: '0'}\n");
  expect_same_loop(model.default_vehicle(), paper_platoon().default_vehicle());
}

const std::string kWithClosedLoop = kClosedLoopText + "\n" + kModelText.substr(kModelText.find("time_headway"));

TEST(ModelFile, MayHaveTheClosedLoopInsteadOfPlantAndController) {
  const PlatoonModel designed = model_of(kModelText), given = model_of(kWithClosedLoop);
  expect_nearly_same_loop(given.default_vehicle(), designed.default_vehicle());
  EXPECT_TRUE(designed.default_vehicle().design);
  EXPECT_FALSE(given.default_vehicle().design);
}

// All processes must read the same bits from the text that one of them writes.
TEST(ModelFile, IsReadBackToTheBit) {
  const std::string uneven = model_text_with("numerator: [1.0], denominator: [1.0, -2.0, 1.0]",
                                             "numerator: [0.7], denominator: [0.7, -1.4, 0.7]");
  for (const std::string& text : {kModelText, uneven, kWithClosedLoop, model_text_with("0.6", "0.1")}) {
    const PlatoonModel model = model_of(text), again = model_of(to_json(model).dump());
    expect_same_loop(again.default_vehicle(), model.default_vehicle());
    EXPECT_EQ(again.default_vehicle().loop.transfer.denominator(), model.default_vehicle().loop.transfer.denominator());
    EXPECT_EQ(again.default_vehicle().position().noise_variance, model.default_vehicle().position().noise_variance);
    EXPECT_EQ(to_json(again), to_json(model));
  }
}

const std::string kTypesText =
    kModelText +
    "channel: {noise_filter: {numerator: [1.0, 0.3], denominator: [1.0, -0.5, 0.1]}, quantisation_step: 0.5, delay: 2,\n"
    "          loss: {probability: 0.2, mean_burst: 2.5, on_loss: extrapolate}}\n"
    "vehicle_types:\n"
    "  truck: {time_headway: 4.0, standstill_distance: 5.0, channel: {delay: 1, loss: {probability: 0.1}}}\n"
    "  bus: {noise_variance: 0.1, initial_position: {mean: 1.0, variance: 2.0},\n"
    "        controller: {numerator: [1.3, 0.0], denominator: [1.0, 0.89], divide_by_one_plus_headway: true}}\n"
    "string: [default, truck, default, bus]\n";

TEST(ModelFile, SetsChannelsAndTypesThatInheritFromTheDefaultVehicle) {
  const PlatoonModel model = model_of(kTypesText);
  EXPECT_EQ(model.default_vehicle().position().link.noise_filter.numerator(), Eigen::Vector2d(1.0, 0.3));
  EXPECT_EQ(model.default_vehicle().position().link.quantisation_step, 0.5);
  EXPECT_EQ(model.default_vehicle().position().link.delay, 2);
  ASSERT_TRUE(model.default_vehicle().position().link.loss);
  EXPECT_EQ(model.default_vehicle().position().link.loss->probability, 0.2);
  EXPECT_EQ(model.default_vehicle().position().link.loss->mean_burst, 2.5);
  EXPECT_EQ(model.default_vehicle().position().link.loss->predictor, (std::vector<double>{2.0, -1.0}));
  ASSERT_EQ(model.types.size(), 3u);
  const VehicleModel &bus = model.types[1].vehicle, &truck = model.types[2].vehicle;
  EXPECT_EQ(truck.headway, 4.0);
  expect_same_loop(truck, paper_platoon(4.0).default_vehicle());
  EXPECT_EQ(truck.standstill_distance, 5.0);
  EXPECT_EQ(truck.position().noise_variance, 0.6);
  EXPECT_EQ(truck.position().link.delay, 1);
  EXPECT_EQ(truck.position().link.quantisation_step, 0.5);
  EXPECT_EQ(truck.position().link.loss->probability, 0.1);
  EXPECT_EQ(truck.position().link.loss->predictor, (std::vector<double>{2.0, -1.0}));
  EXPECT_EQ(bus.headway, 3.2);
  EXPECT_EQ(bus.position().noise_variance, 0.1);
  EXPECT_EQ(bus.initial_position.variance, 2.0);
  EXPECT_NE(bus.loop.realization.b(), model.default_vehicle().loop.realization.b());
  EXPECT_TRUE(bus.position().link == model.default_vehicle().position().link);
  for (const VehicleType& type : model.types) EXPECT_TRUE(type.inherited.mean_burst) << type.name;
  EXPECT_FALSE(model.types[2].inherited.loss_probability);
  EXPECT_EQ(with_mean_burst(model, 3.0).types[2].vehicle.position().link.loss->mean_burst, 3.0);
  EXPECT_EQ(model.string, (std::vector<std::size_t>{0, 2, 0, 1}));
  EXPECT_FALSE(is_homogeneous(model));
  for (const std::size_t i : {2, 6}) EXPECT_EQ(vehicle(model, i).headway, 4.0);
  EXPECT_EQ(place_in_formation(model, 7), -10.0);
}

TEST(ModelFile, KeepsAMeanBurstInheritedInEveryCopy) {
  nlohmann::json document = to_json(model_of(kTypesText));
  document["channel"]["loss"]["mean_burst"] = 1.5;
  for (const VehicleType& type : model_of(document.dump()).types)
    EXPECT_EQ(type.vehicle.position().link.loss->mean_burst, 1.5);
}

TEST(ModelFile, KeepsNoiseAndChannelInheritedInEveryCopy) {
  nlohmann::json document =
      to_json(model_of(kModelText + "vehicle_types: {other: {time_headway: 4}, own: {noise_variance: 0.6, "
                                    "channel: {delay: 1}}}\nstring: [other, own]\n"));
  document["noise_variance"] = 2.0;
  document["channel"]["delay"] = 3;
  const PlatoonModel copy = model_of(document.dump());
  EXPECT_EQ(copy.types[1].vehicle.position().noise_variance, 2.0);
  EXPECT_EQ(copy.types[1].vehicle.position().link.delay, 3);
  EXPECT_EQ(copy.types[2].vehicle.position().noise_variance, 0.6);
  EXPECT_EQ(copy.types[2].vehicle.position().link.delay, 1);
  EXPECT_EQ(to_json(copy), to_json(model_of(to_json(copy).dump())));
}

TEST(ModelFile, SetsTheClosedLoopOfAType) {
  const PlatoonModel model =
      model_of(kModelText + "vehicle_types: {twin: {" + kClosedLoopText + "}}\nstring: [twin]\n");
  expect_nearly_same_loop(vehicle(model, 1), model.default_vehicle());
  EXPECT_FALSE(vehicle(model, 1).design);
  EXPECT_TRUE(vehicle(model, 0).design);
  // A, B, C hold for one headway: another headway needs other matrices.
  EXPECT_TRUE(is_problem(
      problems_in(kModelText + "vehicle_types: {twin: {time_headway: 4, " + kClosedLoopText + "}}\nstring: [twin]\n"),
      "vehicle_types/twin: no double integral action"));
}

TEST(ModelFile, IsReadBackToTheBitWithChannelsAndTypes) {
  const PlatoonModel model = model_of(kTypesText), again = model_of(to_json(model).dump());
  EXPECT_EQ(to_json(again), to_json(model));
  EXPECT_EQ(again.string, model.string);
  for (std::size_t i = 0; i < model.types.size(); ++i) {
    EXPECT_TRUE(again.types[i].vehicle.position().link == model.types[i].vehicle.position().link);
    expect_same_loop(again.types[i].vehicle, model.types[i].vehicle);
  }
}

TEST(ModelFile, NeedsNeitherChannelsNorTypes) {
  const nlohmann::json document = to_json(model_of(kModelText));
  for (const char* key : {"channel", "vehicle_types", "string"}) EXPECT_FALSE(document.contains(key)) << key;
  EXPECT_TRUE(is_papers(model_of(kModelText)));
  EXPECT_TRUE(is_papers(model_of(kModelText + "channel: {delay: 0, loss: {probability: 0}}\nstring: [default]\n")));
  EXPECT_FALSE(is_papers(model_of(kModelText + "channel: {delay: 1}\n")));
}

TEST(LoadYaml, NamesAMissingFile) {
  EXPECT_EQ(
      problems_of([] { load_yaml("/no/such/model.yaml"); }),
      Problems{
          "model: /no/such/model.yaml: must be a regular file of at most 256 MB that can be read (No such file or directory)"});
}

TEST(ParseYaml, GivesEachAliasAValueOfItsOwn) {
  YAML::Node document = parse_yaml("model: {a: &x {b: [1, 2]}, c: *x, d: &y 3, e: *y}", "model");
  override_value(document, "a/b/0", YAML::Node(7));
  override_value(document, "d", YAML::Node(8));
  EXPECT_EQ(YAML::Dump(document["model"]["c"]), "b:\n  - 1\n  - 2");
  EXPECT_EQ(document["model"]["e"].Scalar(), "3");
  EXPECT_EQ(YAML::Dump(document["model"]["a"]), "b:\n  - 7\n  - 2");
  EXPECT_EQ(document["model"]["d"].Scalar(), "8");
}

TEST(ParseYaml, ChangesNoKeyOfATypeThatIsMissing) {
  const auto problem_of = [](const std::string& text, const char* name) {
    YAML::Node document = parse_yaml(text, "model");
    return message_of<ConfigurationError>([&] { override_value(document, name, YAML::Node(7)); });
  };
  const std::string types = "model: {vehicle_types: {truck: {}, car: {}}}", key = "vehicle_types/heavy/noise_variance";
  EXPECT_EQ(problem_of(types, key.c_str()), key + ": must be a key of one of the vehicle types: car, truck");
  EXPECT_EQ(problem_of("model: {}", key.c_str()),
            key + ": must be a key of one of the vehicle types: the model has none");
  YAML::Node document = parse_yaml(types, "model");
  override_value(document, "vehicle_types/car/noise_variance", YAML::Node(7));
  EXPECT_EQ(document["model"]["vehicle_types"]["car"]["noise_variance"].Scalar(), "7");
}

TEST(ParseYaml, RejectsAliasesWithoutEnd) {
  std::string powers = "a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8]\n";
  for (int n = 0; n < 8; ++n) {
    const std::string last = "*a" + std::to_string(n) + ", ", next = "a" + std::to_string(n + 1);
    powers += next + ": &" + next + " [" + last + last + last + last + last + last + last + last + "]\n";
  }
  for (const std::string& text : {powers, std::string("a: &x [*x]")}) {
    EXPECT_TRUE(is_problem(problems_of([&text] { parse_yaml(text, "model"); }),
                           "model: aliases stand for more than 100000 values or 100 levels"));
  }
}

TEST(ParseYaml, CountsTheValuesOfAliasesAlone) {
  std::string positions = "positions: [0";
  for (int k = 0; k < 120000; ++k) positions += ", 1";
  EXPECT_EQ(parse_yaml(positions + "]\na: &v 0.6\nb: *v\n", "model")["positions"].size(), 120001u);
}

TEST(LoadYaml, NamesAFileThatIsNotYaml) {
  const TemporaryFolder folder;
  const std::string file = folder.file("model.yaml", "plant: [1, 2");
  EXPECT_TRUE(is_problem(problems_of([&file] { load_yaml(file); }), "model: " + file + ": must be YAML: "));
}

TEST(LoadYaml, NamesAFolderInPlaceOfTheFile) {
  const TemporaryFolder folder;
  EXPECT_TRUE(
      is_problem(problems_of([&folder] { load_yaml(folder.path()); }), "model: " + folder.path() + ": must be "));
}

}  // namespace
}  // namespace platoon
