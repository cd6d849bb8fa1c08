// The theory of the paper's platoon from C++: verdict, critical headway, and the variance along the string.

#include <cstdio>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"

namespace {

// G(z) = 1 / (z - 1)^2 and K(z) = 1.35 / (1 + h) z / (z + 0.89), behind a leader at 20 m/s; noise of 0.6 m^2.
platoon::PlatoonModel paper_platoon(double headway) {
  const platoon::TransferFunction plant(Eigen::VectorXd::Ones(1), Eigen::Vector3d(1.0, -2.0, 1.0));
  const platoon::TransferFunction controller(Eigen::Vector2d(1.35, 0.0), Eigen::Vector2d(1.0, 0.89));
  const platoon::LoopDesign design{plant, controller, true};
  platoon::VehicleModel vehicle{platoon::close_loop(design, headway), headway};
  vehicle.position().noise_variance = 0.6;
  vehicle.design = design;
  return {vehicle, platoon::LeaderProfile({{0, 20.0}}, 0.1)};
}

}  // namespace

int main() {
  const platoon::PlatoonModel model = paper_platoon(3.2);  // h in sample periods: 0.32 s
  const platoon::StringStability verdict = platoon::string_stability(model);
  const std::optional<platoon::StableHeadways> headways = platoon::stable_headways(model);
  const std::vector<double> variances = platoon::stationary_variances(model, 20);
  std::printf("%s\n", verdict.reason.c_str());
  if (headways && headways->critical) {
    std::printf("critical headway %.4f s, here %.4f s\n", *headways->critical * model.sample_period,
                model.default_vehicle().headway * model.sample_period);
  }
  std::printf("variance %.6f m^2 of follower 1, %.6f m^2 of follower 20\n", variances.front(), variances.back());
  if (verdict.limit_variance) std::printf("variance %.6f m^2 in an endless string\n", *verdict.limit_variance);
  return 0;
}
