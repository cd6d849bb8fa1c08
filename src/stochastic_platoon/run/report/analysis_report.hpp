#pragma once

#include <string>

#include "stochastic_platoon/run/report/analysis.hpp"

namespace platoon {

/// Text report: the verdict first, then the reasons.
std::string report(const Configuration& configuration, const Analysis& analysis);

}  // namespace platoon
