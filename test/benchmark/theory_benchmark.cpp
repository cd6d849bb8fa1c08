// The time of the theory, beside that of the dense solution that it replaces.

#include <benchmark/benchmark.h>

#include "../unit/math/paper/lemma_one.hpp"
#include "../unit/math/radio_cars.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"

namespace {

platoon::LoopDesign paper_design() {
  return {platoon::TransferFunction(Eigen::VectorXd::Ones(1), Eigen::Vector3d(1.0, -2.0, 1.0)),
          platoon::TransferFunction(Eigen::Vector2d(1.35, 0.0), Eigen::Vector2d(1.0, 0.89)), true};
}

// The numerical example of the paper, h = 3.2.
platoon::PlatoonModel paper_model() {
  const double headway = 3.2;
  platoon::VehicleModel vehicle(platoon::close_loop(paper_design(), headway), headway);
  vehicle.position().noise_variance = 0.6;
  return {vehicle, platoon::LeaderProfile({{0, 20.0}}, 0.1)};
}

void StringStability(benchmark::State& state) {
  const platoon::PlatoonModel model = paper_model();
  for (auto _ : state) benchmark::DoNotOptimize(platoon::string_stability(model));
}
BENCHMARK(StringStability)->Unit(benchmark::kMillisecond);

void CriticalHeadway(benchmark::State& state) {
  platoon::PlatoonModel model = paper_model();
  model.default_vehicle().design = paper_design();
  model.types.front().inherited.headway = true;
  for (auto _ : state) benchmark::DoNotOptimize(platoon::stable_headways(model));
}
BENCHMARK(CriticalHeadway)->Unit(benchmark::kMillisecond);

// A car with 20 poles at z = 0 at the headway of config/acc.yaml, and with the radio of config/cacc.yaml.
void CriticalHeadwayOfCar(benchmark::State& state) {
  const bool has_radio = state.range(0) > 0;
  platoon::PlatoonModel model = platoon::radio_platoon(has_radio ? 0.5 : 3.5, 0.01, 0.01);
  if (!has_radio) model.default_vehicle().inputs.resize(1);
  for (auto _ : state) benchmark::DoNotOptimize(platoon::stable_headways(model));
}
BENCHMARK(CriticalHeadwayOfCar)->ArgName("radio")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void SignalMoments(benchmark::State& state) {
  const platoon::PlatoonModel model = paper_model();
  const auto followers = static_cast<std::size_t>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(platoon::error_moments(model, followers, state.range(1)));
}
BENCHMARK(SignalMoments)->Args({20, 100})->Args({10000, 1000})->Unit(benchmark::kMillisecond);

void ErrorMomentsByLemmaOne(benchmark::State& state) {
  const platoon::PlatoonModel model = paper_model();
  const auto followers = static_cast<std::size_t>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(platoon::error_moments_by_lemma_one(model, followers, state.range(1)));
}
BENCHMARK(ErrorMomentsByLemmaOne)->Args({20, 100})->Unit(benchmark::kMillisecond);

void StationaryVariances(benchmark::State& state) {
  const platoon::PlatoonModel model = paper_model();
  const auto followers = static_cast<std::size_t>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(platoon::stationary_variances(model, followers));
}
BENCHMARK(StationaryVariances)->Arg(20)->Arg(100)->Arg(1000000)->Unit(benchmark::kMillisecond);

void StationaryVariancesByDenseLyapunov(benchmark::State& state) {
  const platoon::PlatoonModel model = paper_model();
  const platoon::StringMatrices matrices =
      platoon::string_matrices(model.default_vehicle().loop.realization, model.default_vehicle().headway,
                               static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        platoon::stationary_covariance_by_lyapunov(matrices, model.default_vehicle().position().noise_variance));
  }
}
BENCHMARK(StationaryVariancesByDenseLyapunov)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
