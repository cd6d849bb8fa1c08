#pragma once

#include <cstdint>

#include "stochastic_platoon/math/simulation/ensemble_run.hpp"

namespace platoon {

/// All statistics over realizations 0 .. realizations - 1, computed in memory.
inline EnsembleTotals monte_carlo(const PlatoonModel& model, const Ensemble& ensemble, std::uint64_t realizations,
                                  unsigned threads = 1) {
  EnsembleRun run(model, ensemble, {0, realizations});
  complete(run, threads, [] {});
  return run.release();
}

}  // namespace platoon
