#include "stochastic_platoon/math/string/string_theory.hpp"

#include "stochastic_platoon/math/string/hearing_string.hpp"
#include "stochastic_platoon/math/string/linked_string.hpp"

namespace platoon {

std::unique_ptr<const StringTheory> StringTheory::of(const PlatoonModel& model, bool cross_spectra,
                                                     const StringTheory* known) {
  if (cross_spectra || !hears_predecessors_only(model)) return std::make_unique<HearingTheory>(model);
  return std::make_unique<LinkedTheory>(model, dynamic_cast<const LinkedTheory*>(known));
}

}  // namespace platoon
