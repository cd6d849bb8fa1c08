#pragma once

#include <string>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// The assumptions that the loop violates, one sentence each; empty for a loop that can run. The assumptions are:
/// - T is strictly proper and G K has double integral action: S has two zeros at z = 1 (paper, assumption 1 a and b);
/// - the realization in double keeps this: T(1) = 1 also for the rounded coefficients;
/// - rho(A) < 1 and no hidden mode outside the open unit disk, unless `allow_unstable`;
/// - an equilibrium exists; the vehicles start in it.
std::vector<std::string> violated_assumptions(const ClosedLoop& loop, double headway, bool allow_unstable);

/// The same of a vehicle that hears others than its predecessor: rho(A) < 1 at these places of the string, unless
/// `allow_unstable`.
std::vector<std::string> violated_assumptions(const VehicleModel& vehicle, double sample_period,
                                              const std::vector<std::size_t>& places, bool allow_unstable);

/// Where G K cancels unstable modes, which T and all figures lack: "z = 1.2", or "z = 1 +- i 0.5" for a pair.
std::vector<std::string> cancelled_unstable_modes(const ClosedLoop& loop);

/// The deviation of the given loop from double integral action,
/// \f[ |T(1) - 1| + |T'(1) + h| / (1 + h). \f]
/// Given plant and controller it is rounding alone; given A, B and C it depends on their number of digits.
double integral_defect(const ClosedLoop& loop, double headway);

}  // namespace platoon
