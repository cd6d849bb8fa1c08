#include "stochastic_platoon/run/scaling/sweep_file.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/run/configuration/settings.hpp"
#include "unit/messages.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/run/configuration/model_text.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

const std::string kModel = PLATOON_SOURCE_DIR "/config/paper.yaml";

Sweep sweep_of(const std::string& text) {
  const TemporaryFolder folder;
  return read_sweep(folder.file("sweep.yaml", text), {});
}

std::string rejection(const std::string& text) {
  return message_of<ConfigurationError>([&text] { sweep_of(text); });
}

TEST(SweepFile, VariesTheLastAxisFastest) {
  const Sweep sweep = sweep_of("vary: {loss: [0, 0.1], headway: '2.4:4:3'}\nseed: 7\n");
  ASSERT_EQ(sweep.points(), 6u);
  EXPECT_EQ(sweep.name_of(0), "loss = 0, headway = 2.4");
  EXPECT_EQ(sweep.name_of(1), "loss = 0, headway = 3.2");
  EXPECT_EQ(sweep.name_of(5), "loss = 0.1, headway = 4");
  const Configuration last = sweep.configuration(5);
  EXPECT_EQ(last.model.default_vehicle().headway, 4.0);
  EXPECT_EQ(last.model.default_vehicle().position().link.loss->probability, 0.1);
  EXPECT_EQ(last.run.seed, 7u);
  EXPECT_EQ(last.run.batch, 512u);
  EXPECT_EQ(last.run.hosting, Hosting::monte_carlo);
}

TEST(SweepFile, PairsListsOfTheSameLength) {
  const Sweep sweep = sweep_of("combine: paired\nvary: {followers: 10:30:3, headway: [2.4, 3.2, 4]}\n");
  ASSERT_EQ(sweep.points(), 3u);
  EXPECT_EQ(sweep.configuration(1).run.followers, 20u);
  EXPECT_EQ(sweep.configuration(1).model.default_vehicle().headway, 3.2);
  EXPECT_EQ(rejection("combine: paired\nvary: {followers: 10:30:3, headway: [2.4, 3.2]}\n"),
            "combine: paired: headway has 2 values and followers 3: must have as many");
}

TEST(SweepFile, VariesAnyKeyOfTheModelFile) {
  const Sweep sweep = sweep_of(
      "vary: {controller/numerator/0: [1.2, 1.35], channel/delay: [0, 1], leader: [{speed: []}, {speed: "
      "[{from_step: 3, value: 2}]}]}\n");
  ASSERT_EQ(sweep.points(), 8u);
  const PlatoonModel paper = paper_platoon();
  const PlatoonModel first = sweep.configuration(0).model, last = sweep.configuration(7).model;
  EXPECT_NE(first.default_vehicle().loop.transfer.numerator(), last.default_vehicle().loop.transfer.numerator());
  EXPECT_EQ(last.default_vehicle().loop.transfer.numerator(), paper.default_vehicle().loop.transfer.numerator());
  EXPECT_EQ(last.default_vehicle().position().link.delay, 1u);
  EXPECT_EQ(last.leader.changes().size(), 1u);
  // The keys of one point do not affect another.
  EXPECT_EQ(sweep.configuration(0).model.default_vehicle().position().link.delay, 0u);
}

TEST(SweepFile, SetsAKeyOfALinkOnTheInputsOfTheSamePointInAnyOrder) {
  const std::string inputs = "inputs: [[{signal: position, channel: {delay: 1}}]]", delay = "delay: [4]";
  for (const std::string& axes : {inputs + ", " + delay, delay + ", " + inputs}) {
    const Sweep sweep = sweep_of("model: acc.yaml\nvary: {" + axes + "}\n");
    EXPECT_EQ(sweep.configuration(0).model.default_vehicle().position().link.delay, 4u) << axes;
  }
}

TEST(SweepFile, VariesRecordedDrivesBesideIt) {
  const TemporaryFolder folder;
  for (const auto& [name, speed] : {std::pair("slow.csv", "1"), std::pair("fast.csv", "2")}) {
    std::string table = "time,speed\n";
    for (int second = 0; second <= 12; ++second) table += std::to_string(second) + "," + speed + "\n";
    folder.file(name, table);
  }
  const Sweep sweep = read_sweep(folder.file("sweep.yaml", "vary: {leader: [slow.csv, fast.csv, {speed: []}]}\n"), {});
  EXPECT_NEAR(sweep.configuration(0).model.recorded_leader.at(101), 10.0, 1e-9);
  EXPECT_NEAR(sweep.configuration(1).model.recorded_leader.at(101), 20.0, 1e-9);
  EXPECT_TRUE(sweep.configuration(2).model.recorded_leader.empty());
}

TEST(SweepFile, HasTheSettingsOfTheRunsAndTheKeptRows) {
  const Sweep sweep = sweep_of(
      "vary: {headway: [3]}\nrealizations: 1e5\nfollowers: 7\nsteps: 30\nloss: 0.2\nshards: 8\n"
      "keep: {followers: last, steps: all}\n");
  EXPECT_EQ(sweep.configuration(0).run.realizations, 100000u);
  EXPECT_EQ(sweep.configuration(0).run.followers, 7u);
  EXPECT_EQ(sweep.configuration(0).model.default_vehicle().position().link.loss->probability, 0.2);
  EXPECT_EQ(sweep.tasks(), 8u);
  EXPECT_FALSE(sweep.all_followers);
  EXPECT_TRUE(sweep.all_steps);
}

TEST(SweepFile, FindsTheModelBesideIt) {
  const TemporaryFolder folder;
  folder.file("own.yaml", content_of(kModel) + "\nallow_unstable: true\n");
  const std::string file = folder.file("sweep.yaml", "model: own.yaml\nvary: {headway: [0.01]}\n");
  EXPECT_TRUE(read_sweep(file, {}).configuration(0).model.allow_unstable);
}

TEST(SweepFile, FindsShippedModelsAndDrivesByTheirNames) {
  const Sweep shared = sweep_of("model: acc_path.yaml\nleader: city.csv\nvary: {seed: [1]}\n");
  EXPECT_EQ(shared.configuration(0).model.sample_period,
            model_of(content_of(PLATOON_SOURCE_DIR "/config/acc_path.yaml")).sample_period);
  EXPECT_GT(shared.configuration(0).model.recorded_leader.size(), 1000u);
  const Sweep varied = sweep_of("vary: {leader: [city.csv, motorway.csv], seed: [1]}\nfollowers: 3\n");
  EXPECT_NE(varied.configuration(0).model.recorded_leader, varied.configuration(1).model.recorded_leader);
  EXPECT_EQ(varied.name_of(0), "leader = city.csv, seed = 1");
  EXPECT_EQ(sweep_of("vary: {leader/file: [city.csv]}\n").configuration(0).model.recorded_leader,
            varied.configuration(0).model.recorded_leader);
  EXPECT_TRUE(contains(
      rejection("vary: {leader: [cit.csv]}\n"),
      "cit.csv: no such file: must be a table of a drive, or one of the shipped city.csv, emergency_stop.csv, motorway.csv"));
}

TEST(SweepFile, FindsTablesOfLossesBesideIt) {
  const TemporaryFolder folder;
  folder.file("log.csv", "received\n1\n0\n1\n");
  const std::string file =
      folder.file("sweep.yaml", "vary: {channel: [{loss: {trace: log.csv}}, {loss: {probability: 0.1}}]}\nsteps: 10\n");
  EXPECT_EQ(read_sweep(file, {}).configuration(0).model.default_vehicle().position().link.loss->trace->runs(), "1 1 1");
}

TEST(SweepFile, HasTheHeadwayInSecondsAndTheSignals) {
  const Sweep shared = sweep_of("headway_seconds: 0.3\nsignals: gap\nvary: {seed: [1]}\n");
  EXPECT_DOUBLE_EQ(shared.configuration(0).model.default_vehicle().headway, 3.0);
  EXPECT_EQ(shared.configuration(0).run.signals, std::vector<std::string>{"gap"});
  const Sweep varied = sweep_of("headway_seconds: 0.3\nvary: {headway_seconds: [0.28, 0.4]}\n");
  EXPECT_DOUBLE_EQ(varied.configuration(1).model.default_vehicle().headway, 4.0);
  EXPECT_EQ(rejection("vary: {headway: [3], headway_seconds: [0.3]}\n"),
            "vary/headway_seconds: given: must be absent beside headway, which sets it too");
}

TEST(SweepFile, IsRejectedIfASettingStandsBesideItsModelKey) {
  for (const Setting& setting : settings()) {
    if (setting.model_key == nullptr || setting.model_key == std::string(setting.name)) continue;
    const std::string name = setting.name, key = setting.model_key;
    EXPECT_TRUE(contains(rejection("vary: {" + name + ": [0.1], " + key + ": [0.3]}\n"),
                         "vary/" + key + ": given: must be absent beside " + name + ", which sets it too"));
    EXPECT_TRUE(contains(rejection("vary: {" + key + ": [0.1], " + name + ": [0.3]}\n"),
                         "vary/" + name + ": given: must be absent beside " + key + ", which sets it too"));
  }
}

TEST(SweepFile, IsOverriddenByTheCommandLine) {
  const TemporaryFolder folder;
  const std::string file = folder.file("sweep.yaml", "vary: {headway: [3]}\nrealizations: 1e5\n");
  EXPECT_EQ(read_sweep(file, {{"realizations", "17"}}).configuration(0).run.realizations, 17u);
}

TEST(SweepFile, IsRejectedIfItIsTooLarge) {
  EXPECT_EQ(rejection("vary: {headway: 2:4:1000000000, loss: 0:0.5:1000000, delay: [0, 1]}\n"),
            "vary: 1000000000 x 1000000 x 2 = 2e+15 points: must be at most 100000");
  EXPECT_EQ(rejection("combine: paired\nvary: {headway: 2:4:100001, seed: 1:100001:100001}\n"),
            "vary: 100001 points: must be at most 100000");
  EXPECT_EQ(rejection("vary: {seed: [1, 2]}\nkeep: {steps: all}\nfollowers: 10000\nsteps: 1000\n"),
            "keep: 20000000 rows: must be at most 10000000 (keep fewer followers or steps)");
}

TEST(SweepFile, NamesAllErrorsAtOnce) {
  EXPECT_EQ(
      rejection("vary: {headway: 4:2:3, output: [a], delay: []}\ncombine: all\nshard: 3\nkeep: {who: all}\n"),
      "6 errors:\n  vary/headway: 4:2:3: must be a list of values, or FROM:TO:COUNT with FROM <= TO and COUNT from 1\n"
      "  vary/output: given: must be headway, headway_seconds, noise_variance, loss, mean_burst, delay, leader, followers, steps, "
      "seed, realizations, or a key of the model file, as channel/delay\n"
      "  vary/delay: no value: must be a list of values, or FROM:TO:COUNT with FROM <= TO and COUNT from 1\n"
      "  combine: all: must be grid or paired\n"
      "  keep/who: unknown key: allowed are followers, steps\n"
      "  shard: unknown key: allowed are batch, combine, delay, followers, headway, headway_seconds, keep, "
      "leader, loss, mean_burst, model, noise_variance, realizations, seed, shards, signals, steps, vary");
  EXPECT_EQ(rejection("followers: 3\n"), "vary: missing: must be a mapping of keys");
  EXPECT_EQ(rejection("vary: {}\n"), "vary: no axis: must name at least one varying parameter");
}

TEST(SweepFile, NamesTheErrorsOfItsPointsBesideItsOwn) {
  const std::string error = rejection(
      "vary: {foo: [1], loss: [0.5, 1]}\nshards: 0\nkeep: {followers: some}\nshard: 3\nfollowers:\nseed: [2]\n");
  for (const char* part :
       {"7 errors:", "shards: 0: must be a whole number from 1 to 1000000", "keep/followers: some: must be all or last",
        "shard: unknown key: ", "model/foo: unknown key: ", "probability: 1: must be a number from 0 to below 1",
        "run/followers: missing: must be a whole number from 1 to 1000000",
        "run/seed: [2]: must be a whole number from 0 to "})
    EXPECT_TRUE(contains(error, part));
  EXPECT_TRUE(contains(rejection("vary: {seed: [1]}\nsteps: [2]\n"), "run/steps: [2]: must be a whole number"));
}

TEST(SweepFile, NamesThePointsThatCannotRun) {
  const std::string error = rejection("vary: {hedway: [1, 2], headway: [3.2, -1]}\nfollowers: 0\n");
  EXPECT_TRUE(
      contains(error, "point 0 (hedway = 1, headway = 3.2) and 3 more: model/hedway: unknown key: allowed are "));
  EXPECT_TRUE(contains(error,
                       "point 1 (hedway = 1, headway = -1) and 1 more: model/time_headway: -1: must be a finite "
                       "number > 0"));
  EXPECT_TRUE(contains(error, "run/followers: 0: must be a whole number"));
  EXPECT_EQ(rejection("vary: {followers: 10:11:3}\n"),
            "point 1 (followers = 10.5): run/followers: 10.5: must be a whole number from 1 to 1000000");
  EXPECT_EQ(rejection("vary: {time_headway/more: [1]}\n"),
            "point 0 (time_headway/more = 1): time_headway/more: must be a setting, or lead to a key of the model "
            "file");
  EXPECT_EQ(rejection("vary: {controller/numerator/2: [1]}\n"),
            "point 0 (controller/numerator/2 = 1): controller/numerator/2: must be a setting, or lead to a key of "
            "the model file");
  EXPECT_EQ(rejection("vary: {realizations: [3, 10]}\nshards: 4\n"),
            "point 0 (realizations = 3): shards: 4: must be at most the 3 realizations");
  EXPECT_EQ(rejection("vary: {steps: [0]}\n"), "point 0 (steps = 0): steps: 0: must be at least 1 for a Monte Carlo");
  EXPECT_TRUE(contains(rejection("vary: {headway: [0.01]}\n"), "the closed loop is unstable"));
}

TEST(SweepFile, IsValidInTheShippedSweep) {
  const Sweep sweep = read_sweep(PLATOON_SOURCE_DIR "/config/sweeps/headway.yaml", {});
  EXPECT_EQ(sweep.points(), 18u);
}

TEST(WordOf, HasNoCommaAndNoLineBreak) {
  EXPECT_EQ(word_of(YAML::Load("2.40")), "2.40");
  EXPECT_EQ(word_of(YAML::Load("[1, -2, 1]")), "[1 -2 1]");
  EXPECT_EQ(word_of(YAML::Load("\"a,\\nb\"")), "a \\x0ab");
}

}  // namespace
}  // namespace platoon
