#include "stochastic_platoon/theory/effective_sample.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <stdexcept>

#include "stochastic_platoon/model/special_values.hpp"
#include "stochastic_platoon/theory/linked_vehicle.hpp"
#include "stochastic_platoon/theory/pattern_gain.hpp"
#include "stochastic_platoon/theory/pattern_spectra.hpp"
#include "stochastic_platoon/theory/refinement.hpp"

namespace platoon {

namespace {

/// P_i / Phi_zeta_i(0) and P_i^2 / <Phi_zeta_i^2> of followers 1 .. followers, one after the other.
std::vector<double> shares_by(const PatternSpectra& spectra, const std::vector<LinkedVehicle>& vehicles,
                              std::size_t followers) {
  Eigen::ArrayXd position = Eigen::ArrayXd::Zero(spectra.weight.size());
  std::vector<double> shares;
  for (std::size_t i = 0; i < followers; ++i) {
    const std::size_t j = i % vehicles.size();
    if (vehicles[j].has_losses()) break;
    const Eigen::ArrayXd error = spectra.pass(j, spectra.gain[j] * spectra.noise[j], position);
    const double variance = spectra.mean(error);
    // Phi_zeta_i(0): T(1) = H(1) = 1, so that the predecessor's part vanishes.
    shares.push_back(variance == 0.0 ? 1.0 : variance / vehicles[j].at(0.0).noise);
    shares.push_back(variance == 0.0 ? 1.0 : 1.0 / spectra.mean((error / variance).square()));
  }
  shares.resize(2 * followers, kNaN);
  return shares;
}

}  // namespace

std::vector<EffectiveSample> effective_samples(const PlatoonModel& model, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const std::vector<LinkedVehicle> vehicles = linked_pattern(model);
  const auto is_unstable = [](const LinkedVehicle& vehicle) { return vehicle.spectral_radius() >= 1.0; };
  if (std::any_of(vehicles.begin(), vehicles.end(), is_unstable))
    return std::vector<EffectiveSample>(followers, {kNaN, kNaN});
  const PatternGain gain(vehicles);
  const std::vector<double> shares = refined([&](int refinement) {
    return shares_by(PatternSpectra(vehicles, gain, false, refinement), vehicles, followers);
  });
  std::vector<EffectiveSample> samples;
  for (std::size_t i = 0; i < followers; ++i) samples.push_back({shares[2 * i], shares[2 * i + 1]});
  return samples;
}

}  // namespace platoon
