#include "stochastic_platoon/run/scaling/sweep_run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/scaling/sweep_results.hpp"
#include "unit/csv_rows.hpp"
#include "unit/damage.hpp"
#include "unit/messages.hpp"
#include "unit/monte_carlo.hpp"
#include "unit/run/scaling/shard_fixture.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

const std::string kText =
    "vary: {loss: [0, 0.1], headway: [2.4, 3.2]}\nfollowers: 2\nsteps: 5\nrealizations: 2000\nshards: 3\n";

Sweep sweep_of(const std::string& text = kText) {
  const TemporaryFolder folder;
  return read_sweep(folder.file("sweep.yaml", text), {});
}

SweepSettings settings_of(const TemporaryFolder& folder, unsigned threads = 2) {
  std::filesystem::create_directories(folder / "points");
  SweepSettings settings;
  settings.output = folder.path();
  settings.threads = threads;
  return settings;
}

std::string computed(const Sweep& sweep, unsigned threads) {
  const TemporaryFolder folder;
  const SweepSettings settings = settings_of(folder, threads);
  compute_points(sweep, missing_points(sweep, settings), settings);
  EXPECT_TRUE(missing_points(sweep, settings).empty());
  write_sweep(sweep, folder.path());
  return content_of(folder / "sweep.csv");
}

double error_of_lossy(const Configuration& configuration, const std::vector<Moments>& moments, std::size_t cell) {
  RunResult result;
  result.moments = moments;
  const Prediction prediction = predict(configuration);
  const double v = prediction.variance[cell], n = static_cast<double>(moments[cell].count);
  return std::sqrt((fourth_moments(configuration.run, prediction, result)[cell] - v * v) / n);
}

TEST(Sweep, HasARowPerPointAndFollowerOfMeasurementAndTheory) {
  const Sweep sweep = sweep_of();
  const auto table = csv_rows(computed(sweep, 2));
  ASSERT_EQ(table.size(), 9u);
  ASSERT_NE(table[1][12], table[3][12]) << "h = 2.4 and 3.2 differ";
  ASSERT_EQ(table[0],
            (std::vector<std::string>{"point", "loss", "headway", "vehicle", "step", "count", "mean",
                                      "mean_standard_error", "variance", "variance_standard_error", "theoretical_mean",
                                      "theoretical_variance", "string_stable", "agrees"}));
  for (std::uint64_t point = 0; point < 4; ++point) {
    const Configuration configuration = sweep.configuration(point);
    const std::vector<Moments> expected = monte_carlo(configuration.model, {1, 2, 5, 512}, 2000).moments.totals();
    const SignalMoments theory = error_moments(configuration.model, 2, 5);
    for (std::size_t vehicle = 1; vehicle <= 2; ++vehicle) {
      const std::vector<std::string>& row = table[1 + 2 * point + vehicle - 1];
      const std::size_t c = cell(vehicle, 4, 5);
      EXPECT_EQ(row[0], std::to_string(point));
      EXPECT_EQ(row[2], point % 2 == 0 ? "2.4" : "3.2");
      EXPECT_EQ(row[3] + row[4] + row[5], std::to_string(vehicle) + "42000");
      EXPECT_EQ(std::stod(row[6]), expected[c].mean);
      EXPECT_EQ(std::stod(row[7]), standard_error_of_mean(theory.variance[c], 2000));
      EXPECT_EQ(std::stod(row[8]), expected[c].variance());
      EXPECT_EQ(std::stod(row[9]), point < 2 ? standard_error_of_variance(theory.variance[c], 2000)
                                             : error_of_lossy(configuration, expected, c));
      EXPECT_EQ(std::stod(row[10]), theory.mean[c]);
      EXPECT_EQ(std::stod(row[11]), theory.variance[c]);
      EXPECT_EQ(row[12], string_stability(configuration.model).string_stable ? "1" : "0");
      EXPECT_EQ(row[13], "1");
    }
  }
}

TEST(Sweep, LeavesCellsWithoutTheoryEmpty) {
  const Sweep sweep = sweep_of(
      "vary: {channel: [{loss: {probability: 0.5, mean_burst: 1, on_loss: hold}}]}\nfollowers: 2\nsteps: "
      "5\n"
      "realizations: 2000\nkeep: {followers: last, steps: all}\n");
  const auto table = csv_rows(computed(sweep, 1));
  ASSERT_EQ(table.size(), 6u);
  EXPECT_EQ(table[1][2], "2");
  EXPECT_EQ(table[5][3], "4");
  for (std::size_t column = 9; column < 13; ++column) EXPECT_EQ(table[1][column], "") << column;
}

TEST(Sweep, IsTheSameForEveryNumberOfThreadsAndAfterAnInterruption) {
  const Sweep sweep = sweep_of();
  const std::string expected = computed(sweep, 1);
  EXPECT_EQ(computed(sweep, 3), expected);
  const TemporaryFolder folder;
  const SweepSettings settings = settings_of(folder);
  compute_points(sweep, {2, 1}, settings);
  EXPECT_EQ(missing_points(sweep, settings), (std::vector<std::uint64_t>{0, 3}));
  compute_points(sweep, missing_points(sweep, settings), settings);
  write_sweep(sweep, folder.path());
  EXPECT_EQ(content_of(folder / "sweep.csv"), expected);
}

TEST(Sweep, IsTheSameFromTheTasksOfAnArray) {
  const Sweep sweep = sweep_of();
  const TemporaryFolder folder;
  const SweepSettings settings = settings_of(folder);
  const auto task = [&](std::uint64_t number) {
    ShardRun part{sweep.configuration(number / 3), {number % 3, 3}};
    part.configuration.run.output = shard_folder(folder.path(), number / 3, number % 3);
    compute_locked(part);
  };
  const auto rejection = [&] {
    return message_of<ConfigurationError>([&] { merge_points(sweep, missing_points(sweep, settings), settings); });
  };
  EXPECT_EQ(rejection(), "tasks 0-11: missing: must be computed (sbatch --array=0-11)");
  for (const std::uint64_t number : {11, 0, 1, 2, 4, 6, 7, 8}) task(number);
  EXPECT_EQ(rejection(), "tasks 3,5,9-10: missing: must be computed (sbatch --array=3,5,9-10)");
  EXPECT_EQ(missing_points(sweep, settings), (std::vector<std::uint64_t>{1, 3}));
  for (const std::uint64_t number : {3, 5, 9, 10}) task(number);
  std::string fewer = kText;
  fewer.replace(fewer.find("2000"), 4, "1000");
  EXPECT_TRUE(contains(message_of<ConfigurationError>([&] { merge_points(sweep_of(fewer), {1}, settings); }),
                       "of this one: realizations is 2000 there and 1000 here"));
  merge_points(sweep, missing_points(sweep, settings), settings);
  write_sweep(sweep, folder.path());
  EXPECT_EQ(content_of(folder / "sweep.csv"), computed(sweep, 1));
}

TEST(Sweep, RecomputesADamagedPointAndRejectsThoseOfAnotherSweep) {
  const Sweep sweep = sweep_of();
  const TemporaryFolder folder;
  SweepSettings settings = settings_of(folder);
  std::string warning;
  settings.warn = [&warning](const std::string& text) { warning = text; };
  compute_points(sweep, {1}, settings);
  const std::string file = point_file(folder.path(), 1), sound = content_of(file);
  for_each_damage(sound, [&](const std::string& damaged, const std::string& how) {
    std::ofstream(file, std::ios::binary) << damaged;
    warning.clear();
    EXPECT_EQ(missing_points(sweep, settings).size(), 4u) << how;
    EXPECT_TRUE(contains(warning, "is not as it was written: it is computed again")) << how;
  });
  std::ofstream(file, std::ios::binary) << sound;
  EXPECT_EQ(missing_points(sweep, settings).size(), 3u);
  EXPECT_THROW(missing_points(sweep_of(kText + "seed: 2\n"), settings), ConfigurationError);
}

const std::string kLonger =
                      "vary: {loss: [0, 0.1, 0.2], headway: [2.4, 3.2]}\nfollowers: 2\nsteps: 5\nrealizations: 20\n",
                  kShorter = "vary: {loss: [0, 0.1], headway: [2.4, 3.2]}\nfollowers: 2\nsteps: 5\nrealizations: 20\n";

// The number of its lines.
std::size_t write(const TemporaryFolder& folder, const std::string& text) {
  const Sweep sweep = sweep_of(text);
  const SweepSettings settings = settings_of(folder);
  compute_points(sweep, missing_points(sweep, settings), settings);
  write_sweep(sweep, folder.path());
  return csv_rows(content_of(folder / "sweep.csv")).size();
}

TEST(Sweep, OverwritesNoTableButToExtendIt) {
  const TemporaryFolder folder;
  EXPECT_EQ(write(folder, kShorter), 9u);
  EXPECT_EQ(write(folder, kLonger), 13u);
  EXPECT_TRUE(contains(message_of<ConfigurationError>([&] { write(folder, kShorter); }),
                       "output: " + folder.path() + "/sweep.csv: holds rows of another sweep"));
  EXPECT_EQ(csv_rows(content_of(folder / "sweep.csv")).size(), 13u);
}

TEST(Sweep, IsRejectedWhereOneOfItsFilesIsDamaged) {
  const TemporaryFolder folder;
  write(folder, kShorter);
  for (const char* name : {"sweep.csv", "sweep.json"}) {
    const std::string file = folder / name, sound = content_of(file);
    for_each_damage(sound, [&](const std::string& damaged, const std::string& how) {
      std::ofstream(file, std::ios::binary) << damaged;
      EXPECT_TRUE(contains(message_of<std::invalid_argument>([&] { read_table(folder / "sweep.csv"); }), file)) << how;
    });
    std::ofstream(file, std::ios::binary) << with_flipped_bit(sound, 805);
    EXPECT_TRUE(contains(message_of<std::exception>([&] { write(folder, kShorter); }), file));
    EXPECT_EQ(content_of(file), with_flipped_bit(sound, 805)) << "not overwritten";
    std::ofstream(file, std::ios::binary) << sound;
  }
  EXPECT_EQ(read_table(folder / "sweep.csv").columns.size(), 14u);
}

TEST(Sweep, ReplacesNoOtherFileOfTheNameOfItsChecksums) {
  const TemporaryFolder folder;
  const std::string own = folder.file("sweep.json", "{\"vary\": {\"loss\": [0, 0.1]}}");
  EXPECT_TRUE(
      contains(message_of<std::invalid_argument>([&] { write(folder, kShorter); }), own + ": crc32 is missing"));
  EXPECT_TRUE(std::filesystem::is_empty(folder / "points")) << "before a point is computed";
}

TEST(Sweep, GoesOnAfterAKillBetweenItsFilesAndFromAnEarlierVersion) {
  const TemporaryFolder folder;
  write(folder, kShorter);
  const std::string table = folder / "sweep.csv", shorter = content_of(table);
  write(folder, kLonger);
  std::ofstream(table, std::ios::binary) << shorter;
  EXPECT_THROW(read_table(table), std::invalid_argument);
  EXPECT_EQ(write(folder, kLonger), 13u);
  std::filesystem::remove(table);
  EXPECT_EQ(write(folder, kLonger), 13u);
  std::filesystem::remove(folder / "sweep.json");
  EXPECT_EQ(read_table(table).columns.size(), 14u);
  EXPECT_EQ(write(folder, kLonger), 13u);
  EXPECT_TRUE(std::filesystem::exists(folder / "sweep.json"));
}

TEST(Sweep, ReportsAPointThatCannotBeRead) {
  const TemporaryFolder folder;
  const SweepSettings settings = settings_of(folder);
  std::filesystem::create_directory(point_file(folder.path(), 1));
  EXPECT_THROW(missing_points(sweep_of(), settings), std::system_error);
}

TEST(Sweep, ThrowsIfAPointCannotBeWritten) {
  const TemporaryFolder folder;
  SweepSettings settings;
  settings.output = folder / "none";
  settings.threads = 2;
  EXPECT_THROW(compute_points(sweep_of(), {0, 1, 2, 3}, settings), std::runtime_error);
}

}  // namespace
}  // namespace platoon
