#include "stochastic_platoon/math/model/markov_losses.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>

#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "unit/messages.hpp"

namespace platoon {
namespace {

MarkovLosses losses(const Eigen::MatrixXd& transition, const Eigen::VectorXd& probability) {
  return {transition, probability};
}

Eigen::Matrix2d good_and_bad(double to_bad, double back) {
  return (Eigen::Matrix2d() << 1.0 - to_bad, to_bad, back, 1.0 - back).finished();
}

// Gilbert-Elliott: bad with probability 0.1 / 0.4.
TEST(MarkovLosses, HaveTheProbabilityAndTheMeanBurstOfTheirChain) {
  const MarkovLosses found = losses(good_and_bad(0.1, 0.3), Eigen::Vector2d(0.02, 0.7));
  EXPECT_NEAR(found.stationary()(1), 0.25, 1e-15);
  EXPECT_NEAR(found.loss_probability(), 0.75 * 0.02 + 0.25 * 0.7, 1e-15);
  // P(arrived, then lost) per step
  const double begins = 0.75 * 0.98 * (0.9 * 0.02 + 0.1 * 0.7) + 0.25 * 0.3 * (0.3 * 0.02 + 0.7 * 0.7);
  EXPECT_NEAR(found.mean_burst(), found.loss_probability() / begins, 1e-14);
  EXPECT_EQ(losses(good_and_bad(0.1, 0.3), Eigen::Vector2d(0.0, 0.0)).mean_burst(), 1.0);
}

TEST(MarkovLosses, KeepTheDigitsOfARareState) {
  const MarkovLosses found = losses(good_and_bad(1e-200, 0.3), Eigen::Vector2d(0.0, 1.0));
  EXPECT_NEAR(found.loss_probability() / (1e-200 / 0.3), 1.0, 1e-14);
}

TEST(MarkovLosses, LeaveOutStatesThatDoNotReturn) {
  Eigen::Matrix3d begins;
  begins << 0.5, 0.5, 0.0, 0.0, 0.9, 0.1, 0.0, 0.3, 0.7;
  EXPECT_EQ(losses(begins, Eigen::Vector3d(1.0, 0.02, 0.7)).stationary()(0), 0.0);
  LossModel loss;
  loss.markov = std::make_shared<MarkovLosses>(losses(begins, Eigen::Vector3d(1.0, 0.0, 0.7)));
  const LossChain chain(loss);
  EXPECT_EQ(chain.modes(), 3);  // arrived in either state, lost in the last
  EXPECT_EQ(chain.arrived(), 2);
}

TEST(MarkovLosses, AreRejectedWithTheReason) {
  const auto problem = [](const Eigen::MatrixXd& transition, const Eigen::VectorXd& probability) {
    return message_of<std::invalid_argument>([&] { losses(transition, probability); });
  };
  const Eigen::Vector2d half(0.0, 0.5);
  EXPECT_EQ(problem(good_and_bad(0.1, 0.3) * 1.1, half), "transition[0]: a sum of 1.1: must be 1");
  EXPECT_EQ(problem(good_and_bad(-0.1, 0.3), half), "transition[0]: -0.1: must be at least 0");
  EXPECT_EQ(problem(good_and_bad(1.0, 1.0), half),
            "transition: a chain that returns to its states every 2 steps: must have no period");
  EXPECT_EQ(problem(good_and_bad(0.0, 0.0), half),
            "transition: a chain that never changes between states 0 and 1: must mix");
  EXPECT_TRUE(
      begins_with(problem(good_and_bad(1e-9, 1e-9), half), "transition: a chain that leaves a set of states once"));
  EXPECT_EQ(problem(Eigen::MatrixXd::Constant(9, 9, 1.0 / 9.0), Eigen::VectorXd::Zero(9)),
            "transition: 9 x 9: must be square, of 1 to 8 states");
  EXPECT_EQ(problem(good_and_bad(0.1, 0.3), Eigen::Vector3d(0.0, 0.5, 0.5)),
            "probability: 3 numbers: must be one for each of the 2 states");
  EXPECT_EQ(problem(good_and_bad(0.1, 0.3), Eigen::Vector2d(0.0, 1.5)), "probability: 1.5: must be from 0 to 1");
  EXPECT_EQ(problem(good_and_bad(0.1, 0.3), Eigen::Vector2d(1.0, 1.0)),
            "probability: 1 in every state that occurs: must be below 1 in one of them");
}

TEST(LossChain, OfBurstsHasTheirTransitions) {
  const LossChain chain(LossModel{0.2, 2.5, {2.0, -1.0}});
  EXPECT_EQ(chain.modes(), 2);
  EXPECT_EQ(chain.arrived(), 1);
  EXPECT_DOUBLE_EQ(chain.transition()(1, 1), 0.6);
  EXPECT_DOUBLE_EQ(chain.transition()(0, 1), 0.1);
  EXPECT_DOUBLE_EQ(chain.memory(), 0.5);
  EXPECT_EQ(chain.first_moments().rows(), 4);
  EXPECT_EQ(chain.second_moments().rows(), 8);
  EXPECT_EQ(LossChain(LossModel{0.2, {}, {1.0}}).memory(), 0.0);
}

}  // namespace
}  // namespace platoon
