#pragma once

#include <cstddef>
#include <memory>

#include "stochastic_platoon/math/string/hearing_spectra.hpp"

namespace platoon {

/// The endless string with a pattern of this length, whose companion matrices have a spectral radius below 1. At each
/// frequency the cross spectra X in front of a pattern with the product M of its companion matrices satisfy X = M X M*
/// + Q, with Q of what the places add. `spectra` must outlive it.
std::unique_ptr<EndlessString> endless_hearing(const HearingSpectra& spectra, std::size_t period);

}  // namespace platoon
