#include "stochastic_platoon/math/links/loss_scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/links/string_spectra.hpp"
#include "unit/math/lossy_platoon.hpp"

namespace platoon {
namespace {

constexpr double kPi = 3.14159265358979323846;

// The mean and the square of the prediction error per unit of its drive, by 4000 steps of the chain; registers as
// differences.
TEST(LossKernel, PassesAndScattersAsTheChain) {
  const LossModel loss{0.3, 2.2, {1.5, -0.8, 0.3}};
  const LossKernel link(loss);
  const double nu = 0.7;
  const std::complex<double> back = std::polar(1.0, -nu);
  Eigen::Matrix3d arrived = Eigen::Matrix3d::Zero();
  arrived.diagonal(-1).setOnes();
  Eigen::Matrix3d lost = arrived;
  lost.row(0) << 1.5, -0.8, 0.3;
  const double p[2][2] = {{1.0 - loss.after_arrival(), loss.after_arrival()},
                          {1.0 - loss.after_loss(), loss.after_loss()}};
  Eigen::Vector3cd d[2] = {Eigen::Vector3cd::Zero(), Eigen::Vector3cd::Zero()};
  Eigen::Matrix3cd q[2] = {Eigen::Matrix3cd::Zero(), Eigen::Matrix3cd::Zero()};
  for (int k = 0; k < 4000; ++k) {
    const Eigen::Vector3cd to_loss = back * lost * (p[0][1] * d[0] + p[1][1] * d[1]);
    const Eigen::Vector3cd to_arrival = back * arrived * (p[0][0] * d[0] + p[1][0] * d[1]);
    const Eigen::Matrix3cd cross = to_loss * Eigen::RowVector3cd::Unit(0);
    const Eigen::Matrix3cd squared = lost * (p[0][1] * q[0] + p[1][1] * q[1]) * lost.transpose() + cross +
                                     cross.adjoint() +
                                     0.3 * Eigen::Matrix3cd::Identity().col(0) * Eigen::RowVector3cd::Unit(0);
    q[0] = (arrived * (p[0][0] * q[0] + p[1][0] * q[1]) * arrived.transpose()).eval();
    q[1] = squared;
    d[0] = to_arrival;
    d[1] = to_loss + 0.3 * Eigen::Vector3cd::Unit(0);
  }
  const LossKernel::Value value = link.at(nu);
  EXPECT_NEAR(std::abs(value.deviation - d[0](0) - d[1](0)), 0.0, 1e-13);
  Eigen::Matrix3d differences;
  differences << 1.0, 0.0, 0.0, 1.0, -1.0, 0.0, 1.0, -2.0, 1.0;
  for (Eigen::Index mode = 0; mode < 2; ++mode) {
    const Eigen::Vector3cd expected = differences * (q[mode].col(0) - d[mode] * std::conj(value.deviation));
    EXPECT_LT((value.scattered.segment(3 * mode, 3) - expected).norm(), 1e-12);
  }
}

// Parseval: the mean of the scattered spectrum is the variance of the received positions.
TEST(LossKernel, ScattersASpectrumOfTheVarianceAtTheReceiver) {
  for (const LossModel& loss :
       {LossModel{0.2, 6.0, {1.0}}, LossModel{0.6, 1.6, {1.0}}, LossModel{0.1, 1.5, {2.0, -1.0}}}) {
    const LossKernel link(loss);
    for (const double nu : {0.0, 0.3, 2.0}) {
      const LossKernel::Value sent = link.at(nu);
      double sum = 0.0;
      constexpr int kNodes = 1024;
      for (int j = 0; j < kNodes; ++j) {
        const double w = 2.0 * kPi * j / kNodes;
        const double density = link.kernel(link.at(w), w, sent, nu);
        EXPECT_GT(density, -1e-12);
        sum += density / kNodes;
      }
      EXPECT_NEAR(sum, (link.itself() * sent.scattered.real()).value(), 1e-12);
    }
  }
}

TEST(LossKernel, RejectsLossesWithoutTheory) {
  EXPECT_THROW(LossKernel(LossModel{0.0, 2.0, {1.0}}), std::invalid_argument);
  EXPECT_THROW(LossKernel(LossModel{0.5, 1.0, {1.0}}), std::invalid_argument);        // alternating
  EXPECT_THROW(LossKernel(LossModel{0.4, 4.0, {2.0, -1.0}}), std::invalid_argument);  // predictions grow
  EXPECT_NO_THROW(LossKernel(LossModel{0.5, 1.01, {1.0}}));
}

// Transforms on equally spaced nodes and the kernel on other nodes give the same mean.
TEST(LossScatter, ScatterTheSameOnAnyNodes) {
  for (const double mean_burst : {1.05, 3.0}) {
    const LinkedPattern pattern(lossy_platoon({0.2, mean_burst, {1.0}}));
    const StringSpectra equally_spaced(pattern, SpectralNodes(2048)),
        others(pattern, SpectralNodes(half_circle_quadrature({{0.0, 0.05}}, {}, 2)));
    const auto mean = [](const StringSpectra& spectra) {
      const StringSpectra::Input& input = spectra[0].inputs.front();
      return spectra.mean(input.own * (*input.losses)(input.losses->drives(input.own.matrix())).array());
    };
    EXPECT_NEAR(mean(others) / mean(equally_spaced), 1.0, 1e-12);
  }
}

// A chain with memories that are complex numbers.
LossModel losses_in_turn() {
  Eigen::Matrix3d transition;
  transition << 0.1, 0.8, 0.1, 0.1, 0.1, 0.8, 0.8, 0.1, 0.1;
  LossModel loss;
  loss.markov = std::make_shared<MarkovLosses>(transition, Eigen::Vector3d(0.02, 0.1, 0.7));
  loss.probability = loss.markov->loss_probability();
  loss.mean_burst = loss.markov->mean_burst();
  loss.predictor = {1.0};
  return loss;
}

// Reference: the sum over all frequencies of the kernel of a chain, which independent losses are, too.
TEST(LossScatter, ScattersCrossSpectraAsTheKernelDoes) {
  constexpr std::size_t kNodes = 256;
  const auto sent_at = [](double nu) { return std::polar(1.0, -2.0 * nu) / (1.0 - 0.6 * std::polar(1.0, nu)); };
  const std::pair<LossModel, double> cases[] = {// and c_1 + 2 c_2
                                                {{0.3, {}, {1.5, -0.5}}, 0.5},
                                                {{0.3, 2.2, {1.0}}, 1.0},
                                                {{0.2, 1.05, {}}, 0.0},
                                                {losses_in_turn(), 1.0}};
  for (const auto& [loss, slope] : cases) {
    const SpectralNodes nodes(kNodes);
    const LossScatter losses(LossFilter(loss), nodes);
    const LossKernel kernel(loss);
    Eigen::ArrayXcd sent(nodes.count());
    std::vector<double> frequencies;  // w and -w of every node
    for (Eigen::Index k = 0; k < nodes.count(); ++k) {
      frequencies.push_back(nodes.points[static_cast<std::size_t>(k)].frequency);
      frequencies.push_back(-frequencies.back());
      sent(k) = sent_at(frequencies[static_cast<std::size_t>(2 * k)]);
    }
    const Eigen::ArrayXcd found = losses.of_cross_spectrum(sent);
    const LossKernel::Value constant = kernel.at(0.0);
    for (Eigen::Index k = 0; k < nodes.count(); k += 9) {
      const double w = frequencies[static_cast<std::size_t>(2 * k)];
      const LossKernel::Value at_w = kernel.at(w);
      std::complex<double> expected = 0.0;
      for (const double nu : frequencies) {
        const LossKernel::Value at_nu = kernel.at(nu);
        expected += kernel.kernel(at_w, w, at_nu, nu) * std::norm(at_nu.surprise) * sent_at(nu) / double{kNodes};
      }
      EXPECT_LT(std::abs(found(k) - expected), 1e-12 * std::max(1.0, std::abs(expected))) << w;
      const double of_constant = kernel.kernel(at_w, w, constant, 0.0);
      EXPECT_NEAR(losses.of_constant_drive()(k), of_constant, 1e-12 * std::max(1.0, of_constant)) << w;
    }
    EXPECT_NEAR(losses.slope(), slope, 1e-15);
  }
}

TEST(LossScatter, RejectsCrossSpectraOnNodesOfAQuadrature) {
  const SpectralNodes nodes(half_circle_quadrature({{0.0, 0.05}}, {}));
  const LossScatter losses(LossFilter(LossModel{0.3, 2.2, {1.0}}), nodes);
  EXPECT_THROW(losses.of_cross_spectrum(Eigen::ArrayXcd::Zero(nodes.count())), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
