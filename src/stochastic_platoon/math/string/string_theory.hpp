#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/response/pattern_gain.hpp"
#include "stochastic_platoon/math/string/string_walk.hpp"

namespace platoon {

/// What decides whether the gain along a string is below 1 for all w > 0.
struct JudgedGain {
  Sign margin;                 ///< of 1 - gain over all w > 0; zero if the digits of the model do not decide it
  double excess;               ///< of the largest gain over 1
  double frequency;            ///< its frequency [rad/sample]
  bool is_one = false;         ///< at every frequency
  bool grows_at_zero = false;  ///< see LinkedPattern::grows_at_zero()
  bool falls_apart = false;    ///< see HearingGain::falls_apart()
};

/// The end of an endless string.
struct StringEnd {
  /// Factor by which the variance that losses add grows from one round of the string to the next.
  double loss_gain = 0.0;
  double doubt = 1e-9;     ///< of the loss gain beside 1
  bool has_digits = true;  ///< false: only the side of 1 of the loss gain is known
  /// Variances of the tracking errors, one per place of the pattern [m^2]; empty if they were not computed.
  std::vector<double> variances = {};

  bool is_undecided() const { return std::abs(loss_gain - 1.0) <= doubt; }
};

/// The stationary theory of a string: by the LinkedPattern of vehicles that hear their predecessors, or by the
/// HearingSpectra of vehicles that hear any vehicles ahead.
class StringTheory {
public:
  /// The theory that covers a model. `cross_spectra`: HearingSpectra also where vehicles hear their predecessors, as
  /// the control inputs need. `known`: of the same platoon with other headways and links; its unchanged vehicles are
  /// reused. Throws std::invalid_argument for a model without theory: see no_theory().
  static std::unique_ptr<const StringTheory> of(const PlatoonModel& model, bool cross_spectra = false,
                                                const StringTheory* known = nullptr);

  virtual ~StringTheory() = default;
  const PlatoonModel& model() const { return model_; }

  /// The largest rho(A), and the largest growth of the second moments of predictions per step.
  virtual double spectral_radius() const = 0;
  virtual double growth() const = 0;
  bool mean_square_stable() const { return spectral_radius() < 1.0 && growth() < 1.0; }

  /// Means of the tracking errors at the leader's last speed [m]; NaN if the string is not mean square stable.
  virtual std::vector<double> means(std::size_t followers) const = 0;

  /// The gain that verdicts judge, at these frequencies [rad/sample].
  virtual std::vector<double> gains(const std::vector<double>& frequencies) const = 0;
  virtual JudgedGain judged_gain() const = 0;

  /// Whether walks carry cross spectra, which the variance of the control input takes.
  virtual bool has_cross_spectra() const = 0;

  /// Multiplicity of the factor w^2 in 1 - gain^2 over one pattern, less that in the spectra of the noises; 0 where
  /// vehicles hear others.
  virtual int zeros_at_zero() const { return 0; }

  /// The end of a string whose gain is below 1. `with_variances`: if it is string stable. Throws NarrowSpectra.
  virtual StringEnd end(bool with_variances) const = 0;

  /// Positive exactly if the string is string stable without what losses add.
  virtual double gain_margin() const = 0;

  /// The loss gain of a string whose gain margin is positive, on its exact side of 1 at less cost; 0 without losses.
  virtual double loss_gain_beside_one() const = 0;

  /// Positive exactly if the loss gain is below 1: 1 / loss gain - 1; where vehicles hear others, 1 - loss gain.
  virtual double loss_margin() const = 0;

  /// Accuracy of a border of string stability, relative.
  virtual double border_accuracy() const = 0;

  /// values(walk) of this number of followers of a mean square stable string, on nodes that are refined until the
  /// values settle. Throws NarrowSpectra.
  using Values = std::function<std::vector<double>(StringWalk&)>;
  virtual std::vector<double> settled(std::size_t followers, const Values& values) const = 0;

  /// The same with a walk through one pattern of an endless string, which must be string stable.
  virtual std::vector<double> settled_behind_endless(const Values& values) const = 0;

protected:
  explicit StringTheory(PlatoonModel model) : model_(std::move(model)) {}

private:
  PlatoonModel model_;
};

}  // namespace platoon
