#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/links/string_spectra.hpp"

namespace platoon {

using SpectralValues = std::function<std::vector<double>(const StringSpectra&)>;

/// values(spectra) of this number of followers, or of an endless string if there is none, with the number of nodes
/// increased until they settle. Without memory of losses, on the panels of a half_circle_quadrature(). With it, on
/// equally spaced nodes, or on such panels where slow vehicles, long bursts or the border of stability would take
/// thousands.
std::vector<double> settled_values(const LinkedPattern& pattern, std::optional<std::size_t> followers,
                                   const SpectralValues& values);

/// value(spectra) of an endless string, on its exact side of 1 at less cost: near 1 its distance from 1 has few digits.
double settled_beside_one(const LinkedPattern& pattern, const std::function<double(const StringSpectra&)>& value);

}  // namespace platoon
