#include "stochastic_platoon/ros/observation/stall_reporter.hpp"

#include <gtest/gtest.h>
#include <stochastic_platoon/Progress.h>

#include <string>
#include <utility>
#include <vector>

#include "unit/messages.hpp"
#include "unit/paper_run.hpp"

namespace platoon {
namespace {

using stochastic_platoon::Progress;

class StallReporterTest : public testing::Test {
protected:
  static RunOptions run_of(std::vector<std::size_t> external) {
    RunOptions run = paper_run("").run;
    run.followers = 3;
    run.steps = 10;
    run.realizations = run.batch = 4;
    run.stall_timeout = 1.0;
    run.external = std::move(external);
    return run;
  }

  explicit StallReporterTest(std::vector<std::size_t> external = {})
      : run(run_of(std::move(external))),
        arrivals(run.schedule(), 4, 0, 0),
        reporter(run,
                 {"/p/vehicle_0/position", "/p/vehicle_1/position", "/p/vehicle_2/position", "/p/vehicle_3/position"}) {
  }

  // Each follower publishes a step ahead of its predecessor; vehicle 2 stops after its step -1.
  void stop_at_vehicle_2(std::uint32_t attempt, double present) {
    for (const auto& [vehicle, last] :
         std::vector<std::pair<std::size_t, std::int64_t>>{{0, 0}, {1, 1}, {2, -1}, {3, 0}})
      send(vehicle, attempt, -1, last);
    reporter.note_arrival(arrivals, present);
  }

  void send(std::size_t vehicle, std::uint32_t attempt, std::int64_t first, std::int64_t last) {
    for (std::int64_t step = first; step <= last; ++step) send_one(vehicle, {attempt, 0, step});
  }

  void send_one(std::size_t vehicle, const MessageId& id) {
    const MessageDescriptor descriptor{id, 4, true};
    if (arrivals.admit(vehicle, descriptor) == DropReason::none) arrivals.count(vehicle, descriptor);
  }

  StallReporter::Change look(double present) {
    return reporter.look(
        {arrivals, true, [this] { return missing; }, [this](std::size_t) { return breach; }, [this] { return mute; }},
        present);
  }

  RunOptions run;
  Arrivals arrivals;
  StallReporter reporter;
  std::vector<std::size_t> missing = {}, mute = {};
  std::optional<DropReason> breach = {};
};

TEST_F(StallReporterTest, NamesTheBlockingVehicleAndReportsItsEnd) {
  stop_at_vehicle_2(1, 0.1);
  EXPECT_EQ(look(0.2).stalled, "");
  const std::string reason = look(5.0).stalled;
  EXPECT_TRUE(begins_with(reason, "vehicle_2 has sent nothing since step -1"));
  EXPECT_EQ(reporter.culprit(), reason);
  EXPECT_EQ(look(5.1).stalled, "") << "logged once";
  send(2, 1, 0, 2);
  send(3, 1, 1, 3);
  reporter.note_arrival(arrivals, 6.0);
  EXPECT_TRUE(begins_with(look(6.0).moving, ", after "));
  EXPECT_EQ(reporter.culprit(), "");
}

// Regression: the note of a missed attempt was added to every later stall of the vehicle.
TEST_F(StallReporterTest, UsesANoticeForItsOwnAttemptOnly) {
  stop_at_vehicle_2(1, 0.1);
  reporter.receive("vehicle_2", {Progress::MISSED, 1, "has missed messages of attempt 1"});
  const std::string first = look(5.0).stalled;
  EXPECT_TRUE(contains(first, "; it reports: has missed messages of attempt 1"));
  stop_at_vehicle_2(2, 6.1);
  look(6.2);
  const std::string later = reporter.culprit().empty() ? look(20.0).stalled : reporter.culprit();
  EXPECT_TRUE(contains(later, "vehicle_2"));
  EXPECT_FALSE(contains(later, "missed messages"));
}

TEST_F(StallReporterTest, NamesABlockedReceiverByItsKindOfNotice) {
  stop_at_vehicle_2(1, 0.1);
  reporter.receive("recorder", {Progress::NONE, 1, "blocks the run: no"});
  EXPECT_FALSE(contains(look(5.0).stalled, "recorder")) << "text is for people";
  reporter.receive("recorder", {Progress::BLOCKED, 1, "disk full"});
  EXPECT_EQ(look(6.0).stalled, "recorder blocks the run: disk full");
}

// The cause and the vehicle decide, not the text: a vehicle that gets further within the stall is still the same one.
TEST_F(StallReporterTest, LogsAStallOnceThoughItsTextChangesAndAgainForAnotherCauseOrVehicle) {
  missing = {1, 2};
  look(0.0);
  EXPECT_EQ(look(9.0).stalled, "2 of 4 vehicles are not running, the first of them vehicle_1");
  missing = {1};
  EXPECT_EQ(look(10.0).stalled, "");
  EXPECT_EQ(reporter.culprit(), "vehicle_1 is not running: no publisher of /p/vehicle_1/position");
  missing = {2};
  EXPECT_EQ(look(11.0).stalled, "vehicle_2 is not running: no publisher of /p/vehicle_2/position");
  missing = {};
  mute = {2};
  EXPECT_EQ(
      look(12.0).stalled,
      "vehicle_2 publishes no vehicle_2/input, which vehicle_3 receives by radio: it must publish its control input, "
      "or vehicle_3 must have no radio");
}

// Regression: the leader was named, which only waits.
TEST_F(StallReporterTest, NamesAReceiverThatHasNotReportedBeforeTheFirstStep) {
  run.record = "/tmp/run.bag";
  StallReporter recorded(run, {});
  const StallReporter::Observation seen{arrivals, false, [] { return std::vector<std::size_t>(); },
                                        [](std::size_t) { return std::nullopt; },
                                        [] { return std::vector<std::size_t>(); }};
  recorded.look(seen, 0.0);
  EXPECT_EQ(recorded.look(seen, 9.0).stalled, "recorder has not reported, and the leader waits for it");
  recorded.receive("recorder", {Progress::BLOCKED, 0, "no publisher of /p/vehicle_3/input"});
  EXPECT_EQ(recorded.look(seen, 10.0).stalled, "recorder blocks the run: no publisher of /p/vehicle_3/input");
  recorded.receive("recorder", {Progress::NONE, 0, ""});
  EXPECT_EQ(recorded.look(seen, 11.0).stalled, "vehicle_0 (leader) has sent nothing at all");
}

TEST_F(StallReporterTest, NamesMissingVehiclesWithoutAnyNotice) {
  EXPECT_EQ(reporter.text_of("recorder"), "");
  missing = {2};
  EXPECT_EQ(look(0.0).stalled, "");
  EXPECT_EQ(look(9.0).stalled, "vehicle_2 is not running: no publisher of /p/vehicle_2/position");
  missing = {1, 2};
  EXPECT_EQ(look(10.0).stalled, "2 of 4 vehicles are not running, the first of them vehicle_1");
  EXPECT_EQ(reporter.start({1, 2}, arrivals), "waiting for 2 of 4 vehicles");
  EXPECT_EQ(reporter.start({}, arrivals), "first step: 0 %");
}

struct ExternalStallTest : StallReporterTest {
  ExternalStallTest() : StallReporterTest({2}) {}
};

TEST_F(ExternalStallTest, NamesAVehicleThatSendsNoInputToARadio) {
  mute = {2};
  EXPECT_EQ(look(0.0).stalled, "");
  EXPECT_EQ(
      look(9.0).stalled,
      "vehicle_2 is external and publishes no vehicle_2/input, which vehicle_3 receives by radio: it must publish "
      "its control input, or vehicle_3 must have no radio");
}

TEST_F(ExternalStallTest, NamesTheClauseThatAnExternalVehicleViolates) {
  EXPECT_EQ(reporter.start({2}, arrivals), "waiting for external vehicle_2: start its node");
  stop_at_vehicle_2(1, 0.1);
  const std::string silent = look(5.0).stalled;
  EXPECT_TRUE(contains(silent, "; the vehicle is external: clause 2 of the vehicle contract"));
  breach = DropReason::not_finite;
  look(6.0);
  EXPECT_TRUE(contains(reporter.culprit(), "its last message was dropped, as not finite; clause 4"));
}

}  // namespace
}  // namespace platoon
