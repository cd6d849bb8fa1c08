#pragma once

#include <functional>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/math/string/hearing_spectra.hpp"

namespace platoon {

/// Spectra of peaks that 2^18 frequencies do not resolve.
struct NarrowSpectra : std::invalid_argument {
  NarrowSpectra() : std::invalid_argument("the spectra of the string are too narrow to integrate") {}
};

/// values(spectra), with the number of frequencies doubled until they settle to 1e-9 relative; values that remain are
/// then as exact, as their error falls geometrically. Throws NarrowSpectra if 2^18 frequencies do not suffice.
std::vector<double> settled_hearing(const PlatoonModel& model,
                                    const std::function<std::vector<double>(const HearingSpectra&)>& values);

}  // namespace platoon
