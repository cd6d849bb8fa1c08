#include "stochastic_platoon/math/bursts/burst_string.hpp"

#include <cmath>

#include "stochastic_platoon/math/numerics/krylov.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

std::vector<double> variances_by(const BurstSpectra& spectra, double speed, std::size_t followers) {
  std::vector<double> variances;
  Eigen::ArrayXd spectrum = Eigen::ArrayXd::Zero(spectra.nodes());
  for (std::size_t i = 0; i < followers; ++i) {
    const BurstSpectra::Type& type = spectra.of(i);
    const Eigen::ArrayXd added = spectra.added(i, speed) + type.own * spectra.scattered(i, spectrum);
    const double variance = spectra.mean(type.complement * spectrum + type.spacing_gain * added);
    variances.push_back(std::isnan(variance) ? kInfinity : variance);
    if (std::isinf(variances.back())) break;
    spectrum = spectra.gain_of(i) * spectrum + added;
  }
  variances.resize(followers, kInfinity);
  return variances;
}

std::vector<double> limits_by(const BurstSpectra& spectra, double speed) {
  const std::size_t m = spectra.size();
  std::vector<Eigen::ArrayXd> added;
  for (std::size_t j = 0; j < m; ++j) added.push_back(spectra.added(j, speed));
  const LossOperator losses(spectra);
  if (losses.dimensions() > 0) losses.add(solve_one_minus(losses, losses.drives(added)), added);
  std::vector<double> limits;
  Eigen::ArrayXd spectrum = spectra.in_front(added, losses.margin());
  for (std::size_t j = 0; j < m; ++j) {
    const BurstSpectra::Type& type = spectra.of(j);
    limits.push_back(spectra.mean(type.complement * spectrum + type.spacing_gain * added[j]));
    spectrum = spectra.gain_of(j) * spectrum + added[j];
  }
  return limits;
}

}  // namespace

std::vector<double> stationary_variances(const BurstPattern& pattern, double speed, std::size_t followers) {
  return settled_values(pattern, followers,
                        [&](const BurstSpectra& spectra) { return variances_by(spectra, speed, followers); });
}

std::vector<double> limit_variances(const BurstPattern& pattern, double speed) {
  return settled_values(pattern, std::nullopt, [&](const BurstSpectra& spectra) { return limits_by(spectra, speed); });
}

}  // namespace platoon
