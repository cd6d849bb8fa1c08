#pragma once

#include <functional>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/math/string/hearing_spectra.hpp"

namespace platoon {

/// Spectra of peaks that no frequencies of settled_hearing() resolve.
struct NarrowSpectra : std::invalid_argument {
  NarrowSpectra() : std::invalid_argument("the spectra of the string are too narrow to integrate") {}
};

/// When the values at n / 2 and at n frequencies are those of all frequencies.
struct Settling {
  std::function<bool(const std::vector<double>& before, const std::vector<double>& now)> done;
  std::size_t most = std::size_t{1} << 18;  ///< frequencies
};

/// To 1e-9 relative: values whose error falls geometrically are then as exact as their arithmetic.
Settling to_all_digits();

/// values(spectra), with the number of frequencies doubled until they settle. If the largest number does not suffice,
/// they are refined on the panels of a half_circle_quadrature(); with losses, or if they do not settle there either,
/// throws NarrowSpectra.
std::vector<double> settled_hearing(const PlatoonModel& model,
                                    const std::function<std::vector<double>(const HearingSpectra&)>& values,
                                    const Settling& settling = to_all_digits());

}  // namespace platoon
