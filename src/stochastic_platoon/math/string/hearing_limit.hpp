#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/hearing_spectra.hpp"

namespace platoon {

/// The end of an endless string.
struct StringEnd {
  /// Variances of the tracking errors, one per place of the pattern [m^2]; 0 unless the gain is below 1.
  std::vector<double> variances;
  /// Factor by which the variance that losses add grows from one round of the string to the next.
  double loss_gain = 0.0;
};

/// The end of an endless string with a pattern of this length, whose companion matrices have a spectral radius below 1.
/// At each frequency the cross spectra X in front of a pattern with the product M of its companion matrices satisfy X =
/// M X M* + Q. Losses add to Q a nonnegative map of it, the loss gain is its spectral radius.
StringEnd hearing_limit(const HearingSpectra& spectra, std::size_t period, bool loses);

/// A walk from the first place of a pattern on in an endless string whose loss gain is below 1.
HearingWalk walk_behind_endless(const HearingSpectra& spectra, std::size_t period, bool loses);

/// Its loss gain alone, on its exact side of 1, and the variance of the tracking error behind the first place if each
/// place adds a spectrum of 1.
struct LossGain {
  double gain, variance;
};
LossGain hearing_loss_gain(const HearingSpectra& spectra, std::size_t period);

}  // namespace platoon
