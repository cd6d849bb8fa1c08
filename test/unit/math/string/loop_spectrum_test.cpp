#include "stochastic_platoon/math/string/loop_spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "unit/math/string/example_loops.hpp"

namespace platoon {
namespace {

TEST(LoopSpectrum, ValuesAreThoseOfTheTransferFunctions) {
  for (const ExampleLoop& example : example_loops()) {
    const LoopSpectrum spectrum(example.loop, example.headway);
    for (double w = 0.05; w < 3.14; w += 0.05) {
      const std::complex<double> z = std::polar(1.0, w);
      const std::complex<double> t = example.loop.transfer(z);
      const std::complex<double> ht = headway_policy(example.headway)(z) * t;
      const LoopSpectrumValue value = spectrum.at(w);
      const double tolerance = 1e-10 * (1.0 + std::norm(ht));
      EXPECT_NEAR(value.gain, std::norm(t), tolerance) << example.name << " " << w;
      EXPECT_NEAR(value.margin, 1.0 - std::norm(t), tolerance) << example.name << " " << w;
      EXPECT_NEAR(value.known_margin, 1.0 - std::norm(t), tolerance) << example.name << " " << w;
      EXPECT_NEAR(value.sensitivity, std::norm(1.0 - ht), tolerance) << example.name << " " << w;
      EXPECT_NEAR(value.complement, std::norm(ht), tolerance) << example.name << " " << w;
      EXPECT_NEAR(value.ratio * value.known_margin, value.sensitivity, tolerance) << example.name << " " << w;
    }
  }
}

TEST(LoopSpectrum, RatioGoesToZeroAsTheSquareOfTheFrequencyWithoutNoise) {
  // |S|^2 ~ |s|^2 w^4 with s = Q(1)/D(1), 1 - |T|^2 ~ g w^2 with g = h (1+h) - 2 / K(1).
  const LoopSpectrum spectrum(paper_loop(3.2), 3.2);
  const double inverse_gain = 1.89 * 4.2 / 1.35;  // 1 / K(1) = Q(1)/D(1), since S = 1 / (1 + G K H)
  const double expected = inverse_gain * inverse_gain / (3.2 * 4.2 - 2.0 * inverse_gain);
  for (const double w : {1e-3, 1e-6, 1e-9, 1e-12}) {
    EXPECT_NEAR(spectrum.at(w).ratio / (w * w), expected, 1e-5 * expected) << w;
  }
  EXPECT_EQ(spectrum.at(0.0).ratio, 0.0);
}

TEST(LoopSpectrum, CountsTheZerosAtZeroFrequency) {
  EXPECT_EQ(LoopSpectrum(paper_loop(3.2), 3.2).margin_zeros(), 1);
  EXPECT_EQ(LoopSpectrum(paper_loop(3.2), 3.2).sensitivity_zeros(), 2);
  const ExampleLoop flat = string_stable_loops().back();
  EXPECT_EQ(LoopSpectrum(flat.loop, flat.headway).margin_zeros(), 2);
  const TransferFunction plant(Polynomial::Constant(1, 0.02), with_zeros({1.0, 1.0, 1.0}, {}));
  const TransferFunction controller(Eigen::Vector3d(1.0, -1.9, 0.905), Eigen::Vector3d(1.0, 0.0, 0.0));
  EXPECT_EQ(LoopSpectrum(close_loop({plant, controller}, 3.0), 3.0).sensitivity_zeros(), 3);
}

TEST(LoopSpectrum, CoordinatesAndFrequenciesAreInverse) {
  for (const double w : {0.0, 1e-9, 1e-3, 1.0, 1.5, 2.0, 3.0, 3.14159265, 3.141592653589793}) {
    const Centre centre = w < 1.57 ? Centre::kOne : Centre::kMinusOne;
    EXPECT_NEAR(frequency_at(circle_coordinate(w, centre), centre), w, 1e-15 * w) << w;
  }
}

TEST(LoopSpectrum, RefusesALoopThatDoesNotTrackRampsAndAHeadwayThatIsNotPositive) {
  EXPECT_THROW(LoopSpectrum(paper_loop(3.2), 2.0), std::invalid_argument);
  const TransferFunction leading = ramp_tracking(with_zeros({0.5, 0.2}, {}), -1.0, Polynomial::Zero(1));
  EXPECT_THROW(LoopSpectrum(closed_loop_from(observable_canonical(leading)), -1.0), std::invalid_argument);
  EXPECT_THROW(LoopSpectrum(paper_loop(3.2), std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
