#include "stochastic_platoon/run/results/run_store.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "unit/messages.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

class RunStoreTest : public ResultTest {
protected:
  RunStoreTest() { configuration_.run.output = folder_ / "run"; }

  RunStore store() {
    return RunStore(
        configuration_, [this](const std::string& text) { failures_.push_back(text); },
        [this](const std::string& text) { recoveries_.push_back(text); });
  }
  Checkpoint checkpoint(std::uint64_t positions) const {
    return {statistics_identity(configuration_),
            configuration_.run.launch_id,
            {positions, 1, 0.5, 0},
            EnsembleTotals(cells_of(configuration_))};
  }
  /// Creates a folder in the place of a file, so that no user, not even root, can write the file.
  void block(const std::string& file) { std::filesystem::create_directories(file + "/in the way"); }

  std::vector<std::string> failures_, recoveries_;
};

TEST_F(RunStoreTest, SavesAboutOncePerSecondIfPositionsHaveArrived) {
  RunStore store = this->store();
  EXPECT_FALSE(store.start([](const std::string&) {}));
  EXPECT_FALSE(store.is_due(0, 0.0)) << "nothing has arrived";
  ASSERT_TRUE(store.is_due(10, 0.0));
  store.save(checkpoint(10), 0.0);
  EXPECT_TRUE(read_checkpoint(configuration_.run.output));
  EXPECT_FALSE(store.is_due(20, 0.9));
  EXPECT_TRUE(store.is_due(20, 1.0));
  EXPECT_FALSE(store.is_due(10, 1.0)) << "nothing new";
}

TEST_F(RunStoreTest, RepeatsResultsThatCannotBeWrittenAndReportsItOnce) {
  RunStore store = this->store();
  const std::string file = configuration_.run.output + "/statistics.csv";
  block(file);
  const RunResult result = this->result();
  EXPECT_FALSE(store.complete(checkpoint(20), prediction_, result, 5.0));
  EXPECT_FALSE(store.can_write(5.5)) << "a pause of a second";
  ASSERT_TRUE(store.can_write(6.0));
  EXPECT_FALSE(store.complete(checkpoint(20), prediction_, result, 6.0));
  EXPECT_FALSE(store.can_write(7.9)) << "then of two";
  std::filesystem::remove_all(file);
  EXPECT_TRUE(store.complete(checkpoint(20), prediction_, result, 8.0));
  EXPECT_NE(content_of(file), "");
  ASSERT_EQ(failures_.size(), 1u);
  EXPECT_TRUE(contains(failures_[0], "statistics.csv"));
  ASSERT_EQ(recoveries_.size(), 1u);
  EXPECT_EQ(recoveries_[0], configuration_.run.output + ": can be written again");
}

TEST_F(RunStoreTest, AStoppedRunKeepsItsLatestCheckpoint) {
  RunStore store = this->store();
  store.save(checkpoint(10), 0.0);
  const std::string before = content_of(checkpoint_file(configuration_.run.output));
  EXPECT_EQ(store.stop(checkpoint(10), prediction_, result()), "");
  EXPECT_EQ(content_of(checkpoint_file(configuration_.run.output)), before) << "nothing new";
  EXPECT_EQ(store.stop(checkpoint(11), prediction_, result()), "");
  EXPECT_NE(content_of(checkpoint_file(configuration_.run.output)), before);
}

TEST_F(RunStoreTest, AStoppedRunThatCannotBeSavedHasTheReason) {
  RunStore store = this->store();
  block(configuration_.run.output + "/statistics.csv");
  const std::string failure = store.stop(checkpoint(10), prediction_, result());
  EXPECT_TRUE(contains(failure, "/statistics.csv"));
  EXPECT_TRUE(contains(failure, " MB are free there"));
  EXPECT_TRUE(read_checkpoint(configuration_.run.output)) << "resume:=true continues it";
}

TEST_F(RunStoreTest, OneStoreAtATimeHoldsTheFolder) {
  const RunStore first = store();
  Configuration other = configuration_;
  other.run.launch_id = "another launch";
  EXPECT_THROW(RunStore(
                   other, [](const std::string&) {}, [](const std::string&) {}),
               ConfigurationError);
}

}  // namespace
}  // namespace platoon
