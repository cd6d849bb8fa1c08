// The README's "How to add": a vehicle, a channel and a statistic of one's own, each in a few lines.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "stochastic_platoon/configuration/model_file.hpp"
#include "stochastic_platoon/model/tracking_error.hpp"
#include "stochastic_platoon/simulation/platoon_string.hpp"

namespace platoon {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kFollowers = 4;
constexpr std::int64_t kSteps = 60;

PlatoonModel shipped(const std::string& name) {
  return parse_model(load_yaml(PLATOON_SOURCE_DIR "/config/" + name));
}

// A vehicle that is no plant and controller: A, B, C in a model file.
TEST(HowToAdd, AVehicleByItsClosedLoop) {
  const std::vector<Moments> given =
      monte_carlo(shipped("closed_loop.yaml"), {kSeed, kFollowers, kSteps, 100, 100}, 1, [](std::uint64_t) {
      }).totals();
  const std::vector<Moments> designed =
      monte_carlo(shipped("paper.yaml"), {kSeed, kFollowers, kSteps, 100, 100}, 1, [](std::uint64_t) {
      }).totals();
  ASSERT_EQ(given.size(), designed.size());
  // The same loop: coefficients equal to rounding, positions of up to 120 m.
  for (std::size_t c = 0; c < given.size(); ++c) EXPECT_NEAR(given[c].mean, designed[c].mean, 1e-11);
}

// A channel: what is received is a pure function of (seed, i, k, r) and of the position sent, so that a repeated
// message is the same one. This one rounds to centimetres.
double rounded_to_centimetres(double sent) {
  return std::round(100.0 * sent) / 100.0;
}

TEST(HowToAdd, AChannelIsAFunctionOfWhatIsSent) {
  PlatoonModel model = shipped("paper.yaml");
  model.leader = LeaderProfile({{0, 13.37}}, model.sample_period);  // millimetres, that rounding takes away
  LeaderVehicle leader(model);
  FollowerVehicle follower(model, kSeed, 1);
  const TrackingError error{model.headway, model.standstill_distance};
  std::vector<double> own(1);
  double sent = leader.start(), before = 0.0, largest = 0.0;
  follower.start(0, 1, own);
  for (std::int64_t k = 0; k < kSteps; ++k) {
    before = own.front();
    follower.step({rounded_to_centimetres(sent)}, own);
    sent = leader.step();
    if (k > 40) largest = std::max(largest, std::abs(error(sent, own.front(), before)));
  }
  EXPECT_GT(largest, 1e-3) << "the error that rounding leaves";
  EXPECT_LT(largest, 0.5e-2 * 2.69) << "half a centimetre times the sum of |HT|'s impulse response";
}

// A statistic: fed with every zeta_i(k); counts can be merged in any order, so it is the same for every batch size.
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
  PlatoonString string(shipped("paper.yaml"), kSeed, kFollowers);
  Exceedances exceedances;
  for (std::uint64_t first = 0; first < 210; first += batch) {
    string.run(first, batch, kSteps, [&exceedances](std::size_t follower, std::int64_t, const auto& errors) {
      exceedances.add(follower, errors);
    });
  }
  return exceedances;
}

TEST(HowToAdd, AStatisticThatDoesNotDependOnTheBatch) {
  const Exceedances whole = exceedances_in_batches_of(210);
  EXPECT_GT(whole.counts().at(1), 0u);
  for (const std::size_t batch : {1, 7, 70})
    EXPECT_EQ(exceedances_in_batches_of(batch).counts(), whole.counts());
}

}  // namespace
}  // namespace platoon
