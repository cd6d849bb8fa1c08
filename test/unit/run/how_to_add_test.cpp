// The "To extend it" of src/README.md: a new vehicle, channel and statistic, each in a few lines.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/simulation/platoon_string.hpp"
#include "stochastic_platoon/run/configuration/model_file.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"
#include "unit/monte_carlo.hpp"
#include "unit/transmitted.hpp"

namespace platoon {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kFollowers = 4;
constexpr std::int64_t kSteps = 60;

PlatoonModel shipped(const std::string& name) {
  return parse_model(load_yaml(PLATOON_SOURCE_DIR "/config/" + name));
}

// A vehicle without plant and controller: A, B, C in a model file.
TEST(HowToAdd, AVehicleByItsClosedLoop) {
  const auto totals = [](const std::string& name) {
    return monte_carlo(shipped(name), {kSeed, kFollowers, kSteps, 100}, 100).moments.totals();
  };
  const std::vector<Moments> given = totals("closed_loop.yaml"), designed = totals("paper.yaml");
  ASSERT_EQ(given.size(), designed.size());
  // The same loop: coefficients equal to rounding, positions of up to 120 m.
  for (std::size_t c = 0; c < given.size(); ++c) EXPECT_NEAR(given[c].mean, designed[c].mean, 1e-11);
}

// A channel: a stage of the link. This one sends a position only if it differs from the last one sent by more than a
// threshold; otherwise the last one holds (an event-triggered sender). It keeps state: start() sets it, step() updates
// it. A line in channel/link.cpp adds the stage to the others.
class EventTriggered : public LinkStage {
public:
  explicit EventTriggered(double threshold) : threshold_(threshold) {}

  bool keeps_state() const override { return true; }
  void start(std::uint64_t, std::size_t count, double* positions, double) override {
    sent_.assign(positions, positions + count);
  }
  void step(std::int64_t, std::uint64_t, std::size_t count, double* positions) override {
    for (std::size_t r = 0; r < count; ++r) {
      if (std::abs(positions[r] - sent_[r]) > threshold_) sent_[r] = positions[r];
      positions[r] = sent_[r];
    }
  }

private:
  double threshold_;  ///< [m]
  std::vector<double> sent_;
};

TEST(HowToAdd, AChannelAsAStageOfTheLink) {
  const PlatoonModel model = shipped("paper.yaml");
  std::vector<std::unique_ptr<LinkStage>> stages;
  stages.push_back(std::make_unique<EventTriggered>(0.5));
  Link link(std::move(stages));
  EXPECT_TRUE(link.keeps_state());
  LeaderVehicle leader(model);
  FollowerVehicle follower(model, kSeed, 1);
  const Signal error = tracking_error(model, 1);
  std::vector<double> own(1);
  double sent = leader.start(), largest = 0.0;
  follower.start(0, 1, own);
  for (std::int64_t k = -1; k < kSteps; ++k) {
    const std::vector<double> received = transmitted(link, k, 0, {sent});
    EXPECT_LE(std::abs(received.front() - sent), 0.5);
    const double before = own.front();
    follower.step(received, own);
    sent = leader.step();
    if (k > 40) largest = std::max(largest, std::abs(error({sent}, {own.front(), before})));
  }
  EXPECT_LT(largest, 0.5 * 2.69) << "the threshold times the sum of |HT|'s impulse response";
}

// A statistic: receives every zeta_i(k). Counts can be merged in any order, so the batch size has no effect.
class Exceedances {
public:
  void add(std::size_t follower, const std::vector<double>& errors) {
    for (const double error : errors) counts_[follower] += std::abs(error) > 2.0 ? 1 : 0;
  }
  const std::map<std::size_t, std::uint64_t>& counts() const { return counts_; }

private:
  std::map<std::size_t, std::uint64_t> counts_;
};

Exceedances exceedances_in_batches_of(std::size_t batch) {
  const PlatoonModel model = shipped("paper.yaml");
  PlatoonString string(model, kSeed, kFollowers);
  Exceedances exceedances;
  for (std::uint64_t first = 0; first < 210; first += batch) {
    string.run(first, batch, kSteps, [&](std::size_t follower, std::int64_t, const SignalPositions& positions) {
      exceedances.add(follower, positions.of(tracking_error(model, follower)));
    });
  }
  return exceedances;
}

TEST(HowToAdd, AStatisticThatDoesNotDependOnTheBatch) {
  const Exceedances whole = exceedances_in_batches_of(210);
  EXPECT_GT(whole.counts().at(1), 0u);
  for (const std::size_t batch : {1, 7, 70}) EXPECT_EQ(exceedances_in_batches_of(batch).counts(), whole.counts());
}

}  // namespace
}  // namespace platoon
