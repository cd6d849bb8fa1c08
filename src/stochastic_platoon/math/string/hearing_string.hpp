#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/string/hearing_gain.hpp"
#include "stochastic_platoon/math/string/string_theory.hpp"

namespace platoon {

/// Stationary theory of a string whose vehicles hear any vehicles ahead, over links of any losses, by the spectra of
/// HearingSpectra at frequencies that are doubled until the values settle to 1e-9; then they are accurate to 1e-11
/// relative.
class HearingTheory : public StringTheory {
public:
  /// Throws std::invalid_argument for a model without theory: see no_theory().
  explicit HearingTheory(const PlatoonModel& model);

  double spectral_radius() const override;
  double growth() const override { return growth_; }
  std::vector<double> means(std::size_t followers) const override;
  std::vector<double> gains(const std::vector<double>& frequencies) const override;
  JudgedGain judged_gain() const override;

  /// Without variances so near to the border of stability that only the side of 1 of the loss gain is known.
  StringEnd end(bool with_variances) const override;

  double gain_margin() const override;

  /// Accurate to a few hundredths of its distance from 1. Throws NarrowSpectra so near to the border of the gain that
  /// 2^18 frequencies do not resolve its peak.
  double loss_gain_beside_one() const override;

  bool has_cross_spectra() const override { return true; }
  double loss_margin() const override { return 1.0 - loss_gain_beside_one(); }
  double border_accuracy() const override { return 1e-7; }  // each margin takes a verdict of the whole string
  std::vector<double> settled(std::size_t followers, const Values& values) const override;
  std::vector<double> settled_behind_endless(const Values& values) const override;

private:
  const HearingGain& gain() const;

  std::size_t period_;  ///< of the pattern
  double growth_;
  mutable std::optional<double> spectral_radius_;
  mutable std::unique_ptr<const HearingGain> gain_;
};

}  // namespace platoon
