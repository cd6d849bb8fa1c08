#include "stochastic_platoon/math/string/linked_string.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/math/lossy_platoon.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/messages.hpp"

namespace platoon {
namespace {

// Reference: dense second moments of three vehicles with all their registers and modes.
TEST(LossyString, HasTheVariancesOfTheDenseState) {
  const std::vector<double> hold = stationary_variances(lossy_platoon({0.1, 2.0, {1.0}}), 3);
  const std::vector<double> extrapolate = stationary_variances(lossy_platoon({0.1, 1.5, {2.0, -1.0}}), 3);
  const double held[] = {6.949241, 9.448674, 10.647768}, extrapolated[] = {3.422210, 5.155340, 6.096187};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(hold[i], held[i], 5e-7);
    EXPECT_NEAR(extrapolate[i], extrapolated[i], 5e-7);
  }
  EXPECT_NEAR(*string_stability(lossy_platoon({0.2, 3.0, {1.0}})).loss_gain, 0.426077, 5e-7);
}

/// The independent losses of all links as those of a chain with one state.
PlatoonModel by_chains(PlatoonModel model) {
  for (VehicleType& type : model.types) {
    for (Input& input : type.vehicle.inputs) {
      LinkModel& link = input.link;
      if (link.loses())
        link.loss = by_states(Eigen::MatrixXd::Ones(1, 1), Eigen::VectorXd::Constant(1, link.loss->probability),
                              link.loss->predictor);
    }
  }
  return model;
}

void expect_same_theory(const PlatoonModel& independent) {
  const PlatoonModel chains = by_chains(independent);
  const std::vector<double> expected = stationary_variances(independent, 8), found = stationary_variances(chains, 8);
  const std::vector<double> means = stationary_means(independent, 8), found_means = stationary_means(chains, 8);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(found[i] / expected[i], 1.0, 1e-11) << i;
    EXPECT_NEAR(found_means[i], means[i], 1e-11) << i;
  }
  const StringStability one = string_stability(independent), other = string_stability(chains);
  EXPECT_NEAR(one.peak_gain, other.peak_gain, 1e-11);
  EXPECT_EQ(one.decision(), other.decision()) << other.reason;
  ASSERT_EQ(one.loss_gain.has_value(), other.loss_gain.has_value());
  if (!one.loss_gain) return;
  EXPECT_NEAR(*other.loss_gain, *one.loss_gain, 1e-10);
  EXPECT_EQ(LinkedTheory(chains).loss_gain_beside_one() < 1.0, other.string_stable);
  ASSERT_EQ(one.limit_variance.has_value(), other.limit_variance.has_value());
  if (!one.limit_variance) return;
  EXPECT_NEAR(*other.limit_variance / *one.limit_variance, 1.0, 1e-10);
}

// As a chain with one state, independent losses take the way of chains; the two share only the vehicle.
TEST(LossyString, OfIndependentLossesIsThatOfChains) {
  for (const double headway : {2.4, 3.2, 400.0}) {
    expect_same_theory(lossy_platoon({0.1, {}, {2.0, -1.0}}, headway));
    expect_same_theory(lossy_platoon({0.6, {}, {1.0}}, headway));
    PlatoonModel model = lossy_platoon({0.2, {}, {1.5, -0.8, 0.3}}, headway);
    model.default_vehicle().position().link.delay = 3;
    model.default_vehicle().position().link.quantisation_step = 0.5;
    VehicleModel truck = model.default_vehicle();
    truck.position().link.loss = LossModel{0.3, {}, {1.0}};
    truck.position().link.noise_filter = TransferFunction(Eigen::Vector2d(0.8, 0.3), Eigen::Vector2d(1.0, -0.5));
    model.types.push_back({"truck", truck});
    model.types.push_back({"deaf", paper_platoon(4.0).default_vehicle()});
    model.string = {0, 1, 2};
    expect_same_theory(model);
  }
}

TEST(LossyString, OfIndependentLossesOfInputsIsThatOfChains) {
  for (const std::vector<double>& predictor : {std::vector<double>{1.0}, {}, {1.5, -0.8, 0.3}}) {
    PlatoonModel model = radio_platoon(0.5, 0.01, 0.04);
    lose_inputs(model, 0.3, predictor);
    expect_same_theory(model);
    model.default_vehicle().position().link.loss = LossModel{0.1, {}, {2.0, -1.0}};
    add_trucks(model, 0.25, 0.213, 0.9);
    expect_same_theory(model);
  }
}

/// Cooperative adaptive cruise control whose radio loses like this.
PlatoonModel lossy_radios(const LossModel& loss) {
  PlatoonModel model = radio_platoon_of({{car_with_actuator_lag(0.3, 0.0), 0.1}, {ControllerGains{0.5, 1.2, 0.0}, 0.1}},
                                        6.0, 0.01, 0.04, 1, 0.1);
  model.default_vehicle().radio()->link.loss = loss;
  return model;
}

// Reference: an independent program.
TEST(LossyString, HasTheVariancesOfAnIndependentProgramForRadios) {
  const Eigen::Matrix2d gilbert = (Eigen::Matrix2d() << 0.9, 0.1, 0.3, 0.7).finished();
  const std::vector<double> bursts = stationary_variances(lossy_radios({0.15, 4.0, {1.0}}), 3),
                            states = stationary_variances(
                                lossy_radios(by_states(gilbert, Eigen::Vector2d(0.02, 0.7), {1.0})), 2);
  EXPECT_NEAR(bursts[0], 0.00958133, 5e-9);
  EXPECT_NEAR(bursts[1], 0.01440997, 5e-9);
  EXPECT_NEAR(bursts[2], 0.01509071, 5e-9);
  EXPECT_NEAR(states[0], 0.00794405, 5e-9);
  EXPECT_NEAR(states[1], 0.01075884, 5e-9);
}

// The verdict and the growth of the variance along the string agree.
TEST(LossyString, GrowsAlongTheStringExactlyIfTheLossGainIsAboveOne) {
  const StringStability stable = string_stability(lossy_platoon({0.1, 2.0, {2.0, -1.0}}));
  const StringStability unstable = string_stability(lossy_platoon({0.1, 3.0, {2.0, -1.0}}));
  EXPECT_TRUE(stable.string_stable);
  EXPECT_LT(*stable.loss_gain, 1.0);
  EXPECT_FALSE(unstable.string_stable);
  EXPECT_GT(*unstable.loss_gain, 1.0);
  EXPECT_TRUE(begins_with(unstable.reason, "not string stable: the loss gain is "));
  const std::vector<double> growing = stationary_variances(lossy_platoon({0.1, 3.0, {2.0, -1.0}}), 200);
  EXPECT_GT(growing[199] / growing[198], 1.1);
  const std::vector<double> settling = stationary_variances(lossy_platoon({0.1, 2.0, {2.0, -1.0}}), 500);
  EXPECT_LT(settling.back(), *stable.limit_variance);
  EXPECT_NEAR(settling.back() / *stable.limit_variance, 1.0, 1e-3);
}

// Reference: an independent program in extended precision, on panels that resolve the chain. The limit is the variance
// of a string whose loss gain is within 2 / b of 1, and digits are lost there.
TEST(LossyString, HasTheVariancesOfAnIndependentProgramForLongBurstsAndRareLosses) {
  struct Case {
    double probability, mean_burst, first, twentieth, limit, accuracy, accuracy_of_limit;
  };
  for (const Case& of : {Case{0.1, 4.0, 20.912510664101564, 41.89981508183751, 55.616383072922396, 1e-12, 1e-12},
                         Case{0.5, 100.0, 31068.39944674002, 161940.8970417661, 3472670.1795682386, 1e-12, 1e-12},
                         Case{0.5, 800.0, 1928544.654745849, 10413161.817278035, 1741703753.772201, 1e-12, 1e-10},
                         Case{0.5, 2000.0, 12021360.312969036, 65108883.93627369, 27164997812.850403, 1e-12, 1e-9},
                         Case{0.3, 3000.0, 18379224.549375176, 73090082.6093846, 47963763053.0281, 1e-12, 1e-9},
                         Case{0.05, 1e4, 39010681.00325553, 64548682.807445005, 135812462471.87686, 1e-11, 1e-8},
                         Case{0.5, 1e5, 30001067968.99732, 162815795015.4236, 3391607321373692.5, 1e-10, 1e-6},
                         Case{0.1, 1e6, 760002135937.3197, 1684960424887.0007, 3.764004901325612e+17, 1e-9, 1e-5},
                         Case{1e-16, 5.0, 1.3614450580560702, 2.2818242201173304, 2.2926766443893305, 1e-12, 1e-12},
                         Case{1e-12, 5.0, 1.3614450583537856, 2.281824220583883, 2.2926766448756615, 1e-12, 1e-12}}) {
    const PlatoonModel model = lossy_platoon({of.probability, of.mean_burst, {1.0}});
    const std::vector<double> variances = stationary_variances(model, 20);
    const StringStability verdict = string_stability(model);
    EXPECT_NEAR(variances.front() / of.first, 1.0, of.accuracy) << of.probability << " " << of.mean_burst;
    EXPECT_NEAR(variances.back() / of.twentieth, 1.0, of.accuracy) << of.probability << " " << of.mean_burst;
    ASSERT_TRUE(verdict.string_stable) << of.mean_burst << ": " << verdict.reason;
    EXPECT_NEAR(*verdict.limit_variance / of.limit, 1.0, of.accuracy_of_limit) << of.mean_burst;
  }
}

// Reference: all lags of the chain on 2^22 equally spaced frequencies (loss_gain_by_lags() of burst_theory_test.py).
// The drives have a peak of width b^(-1/3) where losses feed on each other most, far from all poles.
TEST(LossyString, HasTheLossGainOfAllLagsForLongBursts) {
  const TransferFunction plant(Eigen::VectorXd::Ones(1), Eigen::Vector3d(1.0, -2.0, 1.0));
  const LoopDesign design{plant,
                          TransferFunction(Eigen::Vector2d(0.04088916224084406, -0.004719188849478725),
                                           Eigen::Vector3d(1.0, 0.826416015625, 0.139367938041687)),
                          true};
  PlatoonModel model = lossy_platoon({0.5825656908801564, 285474.66106715833, {1.0}});
  VehicleModel& vehicle = model.default_vehicle();
  vehicle.headway = 15.241483475734945;
  vehicle.design = design;
  vehicle.loop = close_loop(design, vehicle.headway);
  EXPECT_NEAR(LinkedTheory(model).end(false).loss_gain / 6.1208500913861, 1.0, 3e-11);
}

// Losses that nearly alternate scatter a constant motion into a line at w = pi.
TEST(LossyString, IsContinuousWhereLossesAlternate) {
  const auto variance = [](double beyond) {
    return stationary_variances(lossy_platoon({0.5, 1.0 + beyond, {1.0}}), 5).back();
  };
  const double slope = (variance(2e-5) - variance(1e-5)) / 1e-5, alternating = variance(1e-5) - slope * 1e-5;
  EXPECT_NEAR(variance(1e-7) / (alternating + slope * 1e-7), 1.0, 1e-8);
  EXPECT_NEAR(variance(1e-8) / (alternating + slope * 1e-8), 1.0, 1e-8);
}

// States that lose always or never are the chain of bursts.
TEST(LossyString, OfStatesThatLoseAlwaysOrNeverEqualsThatOfBursts) {
  const Eigen::Matrix2d transition = (Eigen::Matrix2d() << 1.0 - 1.0 / 36.0, 1.0 / 36.0, 0.25, 0.75).finished();
  const PlatoonModel states = lossy_platoon(by_states(transition, Eigen::Vector2d(0.0, 1.0), {1.0})),
                     bursts = lossy_platoon({0.1, 4.0, {1.0}});
  EXPECT_NEAR(stationary_variances(states, 6).back() / stationary_variances(bursts, 6).back(), 1.0, 1e-12);
  const StringStability verdict = string_stability(states);
  ASSERT_TRUE(verdict.string_stable) << verdict.reason;
  EXPECT_NEAR(*verdict.limit_variance / 55.616383072922396, 1.0, 1e-12);
  EXPECT_NEAR(*verdict.loss_gain / 0.4294101216307342, 1.0, 1e-12);
}

// The tables pass covariances from step to step; the stationary variances come from spectra.
TEST(LossyString, OfAnyChainIsWhatItsTablesSettleAt) {
  Eigen::Matrix3d turning;
  turning << 0.1, 0.8, 0.1, 0.1, 0.1, 0.8, 0.8, 0.1, 0.1;
  Eigen::Matrix4d pairs;  // of independent bits: a memory without eigenvectors
  pairs << 0.7, 0.3, 0.0, 0.0, 0.0, 0.0, 0.7, 0.3, 0.7, 0.3, 0.0, 0.0, 0.0, 0.0, 0.7, 0.3;
  const Eigen::Matrix2d gilbert = (Eigen::Matrix2d() << 0.9, 0.1, 0.3, 0.7).finished();
  for (const LossModel& loss : {by_states(gilbert, Eigen::Vector2d(0.02, 0.7), {1.0}),
                                by_states(gilbert, Eigen::Vector2d(0.02, 0.4), {1.5, -0.8, 0.3}),
                                by_states(turning, Eigen::Vector3d(0.02, 0.7, 0.2), {1.0}),
                                by_states(pairs, Eigen::Vector4d(0.1, 0.5, 0.7, 0.9), {1.0})}) {
    const PlatoonModel model = lossy_platoon(loss);
    const std::vector<double> stationary = stationary_variances(model, 3);
    const SignalMoments moments = chain_error_moments(model, 3, 700);
    for (std::size_t i = 1; i <= 3; ++i) EXPECT_NEAR(moments.variance_at(i, 699) / stationary[i - 1], 1.0, 1e-11) << i;
    PlatoonModel radios = lossy_radios(loss);
    radios.default_vehicle().position().link.loss = LossModel{0.1, 2.0, {1.0}};
    const std::vector<double> of_radios = stationary_variances(radios, 2);
    const SignalMoments table = chain_error_moments(radios, 2, 500);
    for (std::size_t i = 1; i <= 2; ++i) EXPECT_NEAR(table.variance_at(i, 499) / of_radios[i - 1], 1.0, 1e-11) << i;
  }
}

TEST(LossyString, HasNoStationaryVarianceIfPredictionsGrow) {
  const PlatoonModel model = lossy_platoon({0.3, 6.0, {2.0, -1.0}});
  EXPECT_TRUE(begins_with(string_stability(model).reason, "not mean square stable: the second moments of predictions"));
  EXPECT_TRUE(std::isnan(stationary_variances(model, 2)[1]));
  EXPECT_TRUE(std::isnan(stationary_means(model, 2)[1]));
}

TEST(LossyString, RejectsModelsWithoutTheory) {
  PlatoonModel radio = lossy_platoon({0.1, 2.0, {1.0}});  // by its closed loop alone
  radio.default_vehicle().inputs.push_back({InputSignal::input});
  EXPECT_THROW(string_stability(radio), std::invalid_argument);
  EXPECT_THROW(stationary_variances(lossy_platoon({0.1, 2.0, {1.0}}), 0), std::invalid_argument);
  EXPECT_THROW(string_stability(lossy_platoon({0.5, 1.0, {1.0}})), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
