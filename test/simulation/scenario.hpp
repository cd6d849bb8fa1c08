#pragma once

#include <string>
#include <vector>

#include "simulation/faults.hpp"

namespace platoon::simulation {

struct Outcome {
  std::string wrong = {};  ///< what was wrong; empty if nothing was
  bool hung = false;       ///< that a run did not end in time
  std::vector<std::string> history = {};
};

/// Carries out a plan in the working folder, whose folder `out` it replaces. A pure function of the plan.
Outcome carry_out(const Plan& plan);

}  // namespace platoon::simulation
