#include "unit/math/paper/spectrum.hpp"
#include "unit/sensitivity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/links/linked_vehicle.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

TransferFunction product(const TransferFunction& f, int power, TransferFunction result) {
  for (int i = 0; i < power; ++i) result = series(result, f);
  return result;
}

TEST(Spectrum, SumsTheNoisesInFront) {
  for (const ExampleLoop& example : example_loops()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    for (const double w : {0.0, 0.01, 0.4, 1.9, 3.1}) {
      const std::complex<double> z = std::polar(1.0, w);
      const std::complex<double> t = example.loop.transfer(z);
      const std::complex<double> ht = headway_policy(example.headway)(z) * t;
      const std::vector<double> spectra = error_spectra(model, 6, w);
      double sum = std::norm(ht);
      for (std::size_t i = 0; i < 6; ++i) {
        if (i > 0) sum += std::norm((1.0 - ht) * std::pow(t, static_cast<int>(i)));
        EXPECT_NEAR(spectra[i], 0.6 * sum, 1e-9 * sum) << example.name << " " << w << " " << i;
      }
    }
  }
}

TEST(Spectrum, HasTheStationaryVarianceAsItsMean) {
  for (const ExampleLoop& example : example_loops()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    const LinkedVehicle vehicle(model.default_vehicle());
    const Quadrature rule = half_circle_quadrature(vehicle.pole_frequencies(), {}, 1);
    std::vector<double> mean(5, 0.0);
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      const std::vector<double> spectra = error_spectra(model, 5, static_cast<double>(rule.node[k]));
      for (std::size_t i = 0; i < 5; ++i) mean[i] += rule.weight[k] * spectra[i];
    }
    const std::vector<double> variances = stationary_variances(model, 5);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(mean[i], variances[i], 1e-10 * mean[i]) << example.name;
  }
}

TEST(Spectrum, HasTheNoiseToErrorNormOfItsEntries) {
  for (const double h : {3.2, 2.4}) {
    const ClosedLoop loop = paper_loop(h);
    const TransferFunction s = sensitivity(loop.transfer, h);
    const TransferFunction ht = series(headway_policy(h), loop.transfer);
    double squares = std::pow(h2_norm(ht), 2);
    for (int m = 1; m < 4; ++m) squares += std::pow(h2_norm(product(loop.transfer, m, s)), 2);
    const double norm = noise_to_error_norm(model_with(loop, h), 4);
    EXPECT_NEAR(norm, std::sqrt(squares), 1e-10 * norm);
    EXPECT_NEAR(stationary_variances(model_with(loop, h), 4).back(), norm * norm * 0.6, 1e-12 * norm * norm);
  }
}

TEST(Spectrum, HasTheFactorOfOneMinusTheSquaredGain) {
  for (const ExampleLoop& example : string_stable_loops()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    const TransferFunction m = spectral_factor(model);
    for (double w = 0.05; w < 3.14; w += 0.1) {
      const std::complex<double> z = std::polar(1.0, w);
      EXPECT_NEAR(std::norm(m(z)), 1.0 - std::norm(example.loop.transfer(z)), 1e-9) << example.name << " " << w;
    }
    EXPECT_GT(m.numerator()(0), 0.0) << example.name;
    for (const std::complex<double>& zero : roots(m.numerator())) {
      EXPECT_LE(std::abs(zero), 1.0 + 1e-6) << example.name;  // two zeros at 1 are found to half the digits
    }
  }
}

TEST(Spectrum, HasAFactorForStringStablePlatoonsOnly) {
  EXPECT_THROW(spectral_factor(model_with(paper_loop(2.4), 2.4)), std::invalid_argument);
  // |T|^2 = 1 / (1 + x ((x - 1)^2 - 0.01)) exceeds 1 about x = 1 only.
  const ExampleLoop bulge = with_gain_from("bulge", roots(Eigen::Vector4d(1.0, -2.0, 0.99, 1.0)));
  EXPECT_THROW(spectral_factor(model_with(bulge.loop, bulge.headway)), std::invalid_argument);
}

TEST(Spectrum, HasH2NormsInClosedForm) {
  const TransferFunction lag(Polynomial::Constant(1, 2.0), Eigen::Vector2d(1.0, -0.5));
  EXPECT_NEAR(h2_norm(lag), 2.0 / std::sqrt(1.0 - 0.25), 1e-14);
  const TransferFunction lead(Eigen::Vector2d(3.0, 0.5), Eigen::Vector2d(1.0, -0.5));  // 3 + 2 / (z - 0.5)
  EXPECT_NEAR(h2_norm(lead), std::sqrt(9.0 + 4.0 / 0.75), 1e-14);
  EXPECT_EQ(h2_norm({Polynomial::Constant(1, -2.0), Polynomial::Ones(1)}), 2.0);
}

TEST(Spectrum, RejectsH2NormsOfImproperAndUnstableFunctions) {
  EXPECT_THROW(h2_norm({Eigen::Vector2d(1.0, 0.0), Polynomial::Ones(1)}), std::invalid_argument);
  EXPECT_THROW(h2_norm({Polynomial::Ones(1), Eigen::Vector2d(1.0, -1.0)}), std::invalid_argument);
}

TEST(Spectrum, DoesNotExistForAnUnstableVehicle) {
  const TransferFunction t = ramp_tracking(polynomial_with_zeros({1.01, 0.2}), 2.0);
  const PlatoonModel model = model_with(closed_loop_from(observable_canonical(t)), 2.0);
  EXPECT_TRUE(std::isnan(error_spectra(model, 2, 1.0).back()));
  EXPECT_TRUE(std::isnan(noise_to_error_norm(model, 2)));
}

TEST(Spectrum, RejectsAnEmptyStringAndFrequenciesOffTheHalfCircle) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  EXPECT_THROW(error_spectra(model, 0, 1.0), std::invalid_argument);
  EXPECT_THROW(error_spectra(model, 2, -0.1), std::invalid_argument);
  EXPECT_THROW(error_spectra(model, 2, 3.2), std::invalid_argument);
  EXPECT_THROW(noise_to_error_norm(model, 0), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
