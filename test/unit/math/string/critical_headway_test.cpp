#include "stochastic_platoon/math/string/critical_headway.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

/// The closed loop at headway h.
using HeadwayLaw = std::function<ClosedLoop(double headway)>;

StableHeadways stable_headways_of(const HeadwayLaw& law, const HeadwayRange& range = {}) {
  return stable_headways(
      [&law](double headway) { return LinkedPattern(model_with(law(headway), headway)).gain_margin(); }, range);
}

/// G = 1/(z-1)^2 with K = gain z / (z + 0.89) at every headway.
HeadwayLaw fixed_gain(double gain) {
  return [gain](double headway) {
    const TransferFunction plant(Eigen::VectorXd::Ones(1), Eigen::Vector3d(1.0, -2.0, 1.0));
    return close_loop({plant, TransferFunction{Eigen::Vector2d(gain, 0.0), Eigen::Vector2d(1.0, 0.89)}}, headway);
  };
}

/// A plant with a lag that the controller cancels: T loses a mode at every headway.
ClosedLoop cancelling(double headway) {
  const TransferFunction plant(Polynomial::Constant(1, 0.02),
                               multiply(Eigen::Vector3d(1.0, -2.0, 1.0), polynomial_with_zeros({0.8, 0.5})));
  const TransferFunction controller(multiply(polynomial_with_zeros({0.8}), Eigen::Vector2d(1.0, -0.9)),
                                    polynomial_with_zeros({0.1, -0.2}));
  return close_loop({plant, controller}, headway);
}

TEST(CriticalHeadway, OfThePapersExampleHasAClosedForm) {
  // 1 - |T|^2 ~ (h (1+h) - 2 / K(1)) w^2 with K(1) = 1.35 / (1.89 (1+h)): h = 2 * 1.89 / 1.35 = 2.8.
  const StableHeadways found = stable_headways_of(paper_loop);
  ASSERT_TRUE(found.critical.has_value());
  EXPECT_NEAR(*found.critical, 2.8, 1e-11);
  ASSERT_EQ(found.intervals.size(), 1u);
  EXPECT_EQ(found.intervals[0].to, 1000.0);
}

TEST(CriticalHeadway, DoesNotExistIfLongHeadwaysAreUnstable) {
  const StableHeadways found = stable_headways_of(fixed_gain(0.3));
  EXPECT_FALSE(found.critical.has_value());
  ASSERT_EQ(found.intervals.size(), 1u);
  const double from = (-1.0 + std::sqrt(1.0 + 8.0 * 1.89 / 0.3)) / 2.0;  // h (1+h) = 2 / K(1)
  EXPECT_NEAR(found.intervals[0].from, from, 1e-11);
  EXPECT_NEAR(found.intervals[0].to, 4.88999962800, 1e-10);
}

TEST(CriticalHeadway, SeparatesStableFromUnstable) {
  const HeadwayLaw laws[] = {paper_loop, fixed_gain(0.3), fixed_gain(0.05), cancelling};
  for (const HeadwayLaw& law : laws) {
    const auto stable = [&](double h) { return string_stability(model_with(law(h), h)).string_stable; };
    for (const HeadwayInterval& interval : stable_headways_of(law).intervals) {
      EXPECT_TRUE(stable(interval.from + 1e-9));
      EXPECT_FALSE(stable(interval.from - 1e-9));
      EXPECT_TRUE(stable(interval.to - 1e-9));
      if (interval.to < 1000.0) {
        EXPECT_FALSE(stable(interval.to + 1e-9));
      }
    }
  }
}

TEST(CriticalHeadway, HasAMarginWithTheSignOfTheVerdict) {
  for (const ExampleLoop& example : example_loops()) {
    const bool stable = string_stability(model_with(example.loop, example.headway)).string_stable;
    EXPECT_EQ(LinkedPattern(model_with(example.loop, example.headway)).gain_margin() > 0.0, stable) << example.name;
  }
  for (const ExampleLoop& example : string_stable_loops()) {
    if (example.name.find("flat") != std::string::npos) continue;  // at the border: the margin is 0 but for rounding
    EXPECT_GT(LinkedPattern(model_with(example.loop, example.headway)).gain_margin(), 0.0) << example.name;
  }
}

TEST(CriticalHeadway, FindsIntervalsNarrowerThanTheSamples) {
  // A gain for which h (1+h) - 2 / K(1) is sign (10^-4 - (h-3)^2), of that sign for 2.99 < h < 3.01 only.
  const auto law = [](double sign) {
    return [sign](double h) {
      const double bump = sign * (1e-4 - (h - 3.0) * (h - 3.0));
      return fixed_gain(2.0 * 1.89 / (h * (1.0 + h) - bump))(h);
    };
  };
  const HeadwayRange range{2.7, 3.6, 8};
  const StableHeadways island = stable_headways_of(law(1.0), range);
  ASSERT_EQ(island.intervals.size(), 1u);
  EXPECT_NEAR(island.intervals[0].from, 2.99, 1e-9);
  EXPECT_NEAR(island.intervals[0].to, 3.01, 1e-9);
  EXPECT_FALSE(island.critical.has_value());
  const StableHeadways gap = stable_headways_of(law(-1.0), range);
  ASSERT_EQ(gap.intervals.size(), 2u);
  EXPECT_EQ(gap.intervals[0].from, 2.7);
  EXPECT_NEAR(gap.intervals[0].to, 2.99, 1e-9);
  EXPECT_NEAR(gap.intervals[1].from, 3.01, 1e-9);
  EXPECT_EQ(gap.critical, gap.intervals[1].from);
}

TEST(CriticalHeadway, RejectsAnEmptyRangeAndTooFewSamples) {
  EXPECT_THROW(stable_headways_of(paper_loop, {0.0, 1.0, 10}), std::invalid_argument);
  EXPECT_THROW(stable_headways_of(paper_loop, {2.0, 1.0, 10}), std::invalid_argument);
  EXPECT_THROW(stable_headways_of(paper_loop, {1.0, INFINITY, 10}), std::invalid_argument);
  EXPECT_THROW(stable_headways_of(paper_loop, {1.0, 2.0, 1}), std::invalid_argument);
}

// A vehicle sampled at a kilohertz keeps headways of thousands of samples.
TEST(CriticalHeadway, IsSearchedAboutTheHeadwayOfTheModel) {
  const double gain = 8.899078748072497e-10, h = 1890.0;
  const TransferFunction plant(Eigen::Vector2d(gain, gain),
                               Eigen::Vector4d(1.0, -2.9982201842503855, 2.996440368500771, -0.9982201842503855));
  const TransferFunction controller(Eigen::Vector2d(1235.158157878057, -1234.4254979937014), Eigen::Vector2d(1.0, 0.0));
  const HeadwayLaw law = [&](double headway) { return close_loop({plant, controller}, headway); };
  ASSERT_TRUE(string_stability(model_with(law(h), h)).string_stable);
  const StableHeadways found = stable_headways_of(law, headways_about(h));
  ASSERT_EQ(found.intervals.size(), 1u);
  EXPECT_LE(found.intervals[0].from, h);
  EXPECT_GE(found.intervals[0].to, h);
  EXPECT_EQ(found.searched.to, 100.0 * h);
}

// An actuator lag of 0.1 s, an input delay of 0.2 s, kp = 0.2, kd = 0.7 at 100 Hz. At low frequencies 1 / (G K) ~
// (z - 1)^2 / (kp T_s^2), hence 1 - |T|^2 ~ (h (1+h) - 2 / (kp T_s^2)) w^2; in continuous time h = sqrt(2 / kp) s.
TEST(CriticalHeadway, OfAdaptiveCruiseControlHasAClosedForm) {
  LoopDesign design{{car_with_actuator_lag(0.1, 0.2), 0.01}, {ControllerGains{0.2, 0.7, 0.0}, 0.01}};
  design.headway_filter = true;
  PlatoonModel model = model_with(close_loop(design, 300.0), 300.0);
  model.default_vehicle().design = design;
  model.types.front().inherited.headway = true;
  const std::optional<StableHeadways> found = stable_headways(model);
  ASSERT_TRUE(found && found->critical);
  const double expected = (-1.0 + std::sqrt(1.0 + 8.0 / (0.2 * 0.01 * 0.01))) / 2.0;
  EXPECT_NEAR(*found->critical, expected, 1e-9 * expected);
  EXPECT_NEAR(0.01 * expected, 3.15728, 1e-5);
}

// Just above the border of abs(T) < 1 the losses alone decide: their gain has a peak at w = 0 whose width goes to zero.
TEST(CriticalHeadway, OfBurstsIsNotThatOfTheGain) {
  const Eigen::VectorXd plant =
      (Eigen::VectorXd(5) << 1.0, -2.91357421875, 2.937535345554352, -1.1343480348587036, 0.1103869080543518)
          .finished();
  const LoopDesign design{TransferFunction(Polynomial::Ones(1), plant),
                          TransferFunction(Eigen::Vector2d(0.0016083567953037066, -0.0008418184819265871),
                                           Eigen::Vector3d(1.0, 1.041748046875, 0.2533121109008789))};
  VehicleModel vehicle(close_loop(design, 40.0), 40.0);
  vehicle.design = design;
  vehicle.position().noise_variance = 2.4;
  vehicle.position().link.loss = LossModel{0.491785172125041, 2.8857295051526712, {1.0}};
  const std::optional<StableHeadways> headways = stable_headways({vehicle, LeaderProfile({{0, 6.75}}, 0.125), 0.125});
  ASSERT_TRUE(headways && !headways->intervals.empty());
  const double border = headways->intervals.front().from;
  const auto loss_gain_at = [&](double headway) {
    VehicleModel at = vehicle;
    at.headway = headway;
    at.loop = close_loop(design, headway);
    return *string_stability({at, LeaderProfile({{0, 6.75}}, 0.125), 0.125}).loss_gain;
  };
  EXPECT_GT(loss_gain_at(border * (1.0 - 1e-9)), 1.0);
  EXPECT_LT(loss_gain_at(border * (1.0 + 1e-9)), 1.0);
}

TEST(CriticalHeadway, NeverContradictsTheVerdictAtAGivenHeadway) {
  const HeadwayLaw laws[] = {paper_loop, fixed_gain(0.3), cancelling};
  for (const HeadwayLaw& law : laws) {
    std::vector<double> headways{0.02, 1.0, 2.8, 4.0, 900.0, 2500.0};
    for (const HeadwayInterval& interval : stable_headways_of(law).intervals) {
      for (const double change : {-1e-12, -1e-14, 0.0, 1e-14, 1e-12})
        headways.push_back(interval.from * (1.0 + change));
    }
    for (const double h : headways) {
      const bool stable = string_stability(model_with(law(h), h)).string_stable;
      bool inside = false;
      for (const HeadwayInterval& interval : stable_headways_of(law, headways_about(h)).intervals)
        inside = inside || (interval.from <= h && h <= interval.to);
      EXPECT_EQ(inside, stable) << h;
    }
  }
}

// Reference: the headway at which the leading coefficient of 1 - |T^|^2 vanishes, in 120 digits. The poles of long
// bursts are within 4e-5 of 1 and nearly cancel the zeros beside them.
TEST(CriticalHeadway, IsExactBehindLongBurstsThatAreExtrapolated) {
  const auto margin_at = [](double headway) {
    const TransferFunction plant(Polynomial::Ones(1),
                                 Eigen::Vector4d(1.0, -1.753173828125, 0.50634765625, 0.246826171875));
    const TransferFunction controller(Eigen::Vector2d(0.10182026425553087, -0.0018321166112019148) / (1.0 + headway),
                                      Eigen::Vector2d(1.0, -0.239013671875));
    PlatoonModel model = model_with(close_loop({plant, controller}, headway), headway);
    model.default_vehicle().position().link.delay = 2;
    model.default_vehicle().position().link.loss = LossModel{2.5036930568425227e-11, 27941.186482832378, {2.0, -1.0}};
    return LinkedPattern(model).gain_margin();
  };
  EXPECT_GT(margin_at(18.9805597009), 0.0);
  EXPECT_LT(margin_at(18.9805590), 0.0);
  const StableHeadways found = stable_headways(margin_at, {});
  ASSERT_TRUE(found.critical.has_value());
  EXPECT_NEAR(*found.critical, 18.9805593782, 4e-9);
}

}  // namespace
}  // namespace platoon
