#include "stochastic_platoon/math/paper/norms.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

TEST(Norms, OfASequenceHaveAClosedForm) {
  const std::vector<double> values{3.0, -4.0, 0.0};
  EXPECT_EQ(sequence_norm(values.data(), 3, NormOrder::kOne), 7.0);
  EXPECT_EQ(sequence_norm(values.data(), 3, NormOrder::kTwo), 5.0);
  EXPECT_EQ(sequence_norm(values.data(), 3, NormOrder::kInfinity), 4.0);
  EXPECT_EQ(sequence_norm(values.data(), 0, NormOrder::kInfinity), 0.0);
}

TEST(Norms, AreTakenPerFollower) {
  const SignalMoments moments{2, 2, {1.0, -1.0, 2.0, 0.0}, {0.5, 0.25, 1.0, 2.0}};
  const ErrorNorms norms = error_norms(moments, NormOrder::kOne, NormOrder::kInfinity);
  EXPECT_EQ(norms.mean, (std::vector<double>{2.0, 2.0}));
  EXPECT_EQ(norms.variance, (std::vector<double>{0.5, 2.0}));
}

TEST(Norms, OfTheMeansFallAlongAStringStablePlatoonAndGrowAlongAnUnstableOne) {
  PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  model.default_vehicle().initial_position = {0.0, 0.0};
  const ErrorNorms stable = error_norms(error_moments(model, 20, 400), NormOrder::kTwo, NormOrder::kInfinity);
  model = model_with(paper_loop(2.4), 2.4);
  model.default_vehicle().initial_position = {0.0, 0.0};
  const ErrorNorms unstable = error_norms(error_moments(model, 20, 400), NormOrder::kTwo, NormOrder::kInfinity);
  for (std::size_t i = 1; i < 20; ++i) {
    EXPECT_LT(stable.mean[i], stable.mean[i - 1]);
    EXPECT_GT(unstable.mean[i], unstable.mean[i - 1]);
    EXPECT_GT(unstable.variance[i], unstable.variance[i - 1]);
  }
}

}  // namespace
}  // namespace platoon
