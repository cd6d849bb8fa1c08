#include "stochastic_platoon/math/model/loss_trace.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>

#include "stochastic_platoon/math/channel/link_stage.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"

namespace platoon {
namespace {

std::vector<bool> entries(const std::string& digits) {
  std::vector<bool> received;
  for (const char digit : digits) received.push_back(digit == '1');
  return received;
}

LossModel recorded(const std::string& digits, std::vector<double> predictor) {
  LossModel loss;
  loss.predictor = std::move(predictor);
  loss.trace = std::make_shared<LossTrace>(entries(digits));
  return loss;
}

TEST(LossTrace, HasItsProbabilityAndMeanBurstAcrossItsEnd) {
  const LossTrace trace(entries("0110010110"));  // losses: the last with the first, two, one
  EXPECT_DOUBLE_EQ(trace.probability(), 0.5);
  EXPECT_DOUBLE_EQ(trace.mean_burst(), 5.0 / 3.0);
  EXPECT_EQ(LossTrace(entries("11")).probability(), 0.0);
}

TEST(LossTrace, EqualsTheTraceOfItsRuns) {
  for (const char* digits : {"1", "1101", "0110", "0000001"}) {
    const LossTrace trace(entries(digits));
    EXPECT_TRUE(LossTrace::of_runs(trace.runs()) == trace) << digits;
  }
  EXPECT_EQ(LossTrace(entries("0110001")).runs(), "0 1 2 3 1");
  EXPECT_FALSE(LossTrace(entries("0110")) == LossTrace(entries("0111")));
}

TEST(LossTrace, RejectsInvalidRuns) {
  for (const char* runs : {"", "0", "0 3", "2 -1", "2 0 1", "2 x", "1.5", "99999999999"})
    EXPECT_THROW(LossTrace::of_runs(runs), std::invalid_argument) << runs;
}

// An arrival ends the growth of a held value; extrapolation remembers the value before a single arrival.
TEST(LossTrace, HasTheGrowthOfPredictions) {
  EXPECT_EQ(growth(LossTrace(entries("1000")), {1.0}), 0.0);
  EXPECT_EQ(growth(LossTrace(entries("11000")), {2.0, -1.0}), 0.0) << "two arrivals end every prediction";
  // After one arrival among n losses the register before it has grown by -n, as r(k) = s + j (s - r(-1)).
  for (const int losses : {1, 2, 3, 7})
    EXPECT_NEAR(growth(LossTrace(entries("1" + std::string(static_cast<std::size_t>(losses), '0'))), {2.0, -1.0}),
                losses, 1e-9);
}

TEST(PacketLoss, FollowsATraceFromARandomOffset) {
  const std::string digits = "1101001110";
  constexpr std::size_t kCount = 20000;
  const std::unique_ptr<LinkStage> loss = packet_loss(recorded(digits, {1.0}), 3, 2);
  std::vector<std::vector<double>> received(25, std::vector<double>(kCount));
  std::vector<double> values(kCount, -1.0);
  loss->start(0, kCount, values.data(), 0.0);
  for (std::size_t k = 0; k < received.size(); ++k) {
    received[k].assign(kCount, static_cast<double>(k));
    loss->step(static_cast<std::int64_t>(k), 0, kCount, received[k].data());
  }
  std::map<std::size_t, double> offsets;
  for (std::size_t r = 0; r < kCount; ++r) {
    std::size_t fitting = 0;
    for (std::size_t offset = 0; offset < digits.size(); ++offset) {
      double last = -1.0;
      bool fits = true;
      for (std::size_t k = 0; k < received.size(); ++k) {
        if (digits[(offset + k) % digits.size()] == '1') last = static_cast<double>(k);
        fits = fits && received[k][r] == last;
      }
      if (!fits) continue;
      ++fitting;
      ++offsets[offset];
    }
    ASSERT_EQ(fitting, 1u) << r;
  }
  // Every offset is as frequent: chi-square with 9 degrees of freedom, exceeded once in 10^4 by chance.
  double chi_square = 0.0;
  const double expected = static_cast<double>(kCount) / 10.0;
  for (std::size_t offset = 0; offset < 10; ++offset)
    chi_square += (offsets[offset] - expected) * (offsets[offset] - expected) / expected;
  EXPECT_LT(chi_square, 33.7);
}

TEST(PacketLoss, HasTheSameOffsetInEveryBatch) {
  const std::unique_ptr<LinkStage> all = packet_loss(recorded("110100", {2.0, -1.0}), 3, 2),
                                   part = packet_loss(recorded("110100", {2.0, -1.0}), 3, 2);
  std::vector<double> of_all(100, 1.0), of_part(3, 1.0);
  all->start(0, 100, of_all.data(), 0.0);
  part->start(41, 3, of_part.data(), 0.0);
  for (std::int64_t k = 0; k < 30; ++k) {
    of_all.assign(100, std::sin(static_cast<double>(k)));
    of_part.assign(3, std::sin(static_cast<double>(k)));
    all->step(k, 0, 100, of_all.data());
    part->step(k, 41, 3, of_part.data());
    for (std::size_t r = 0; r < 3; ++r) EXPECT_EQ(of_part[r], of_all[41 + r]) << k;
  }
}

}  // namespace
}  // namespace platoon
