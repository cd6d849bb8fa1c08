#include "stochastic_platoon/run/configuration/spacing_section.hpp"

namespace platoon {

namespace {

// One of the keys time_headway and time_headway_seconds.
double read_headway(Section& section, double sample_period) {
  if (!section.has("time_headway_seconds") && !section.has("time_headway"))
    section.reject("time_headway", "missing", "a finite number > 0, unless time_headway_seconds is given");
  if (!section.has("time_headway_seconds"))
    return section.has("time_headway") ? section.number("time_headway", kPositive) : 1.0;
  if (section.has("time_headway"))
    section.reject("time_headway_seconds", "given", "absent beside time_headway: exactly one of the two");
  return section.number("time_headway_seconds", kPositive) / sample_period;
}

}  // namespace

void read_spacing(Section& section, const VehicleModel* base, double sample_period, VehicleModel& vehicle) {
  const bool has_headway = section.has("time_headway") || section.has("time_headway_seconds");
  if (section.has("spacing"))
    vehicle.constant_spacing = section.choice("spacing", {"headway", "constant"}) == "constant";
  if (vehicle.constant_spacing) {
    for (const char* key : {"time_headway", "time_headway_seconds"}) {
      if (section.has(key)) section.reject(key, "given", "absent beside spacing: constant");
    }
    vehicle.headway = 0.0;
  } else if (base == nullptr || has_headway || base->constant_spacing) {
    vehicle.headway = read_headway(section, sample_period);
  }
  if (section.has("own_acceleration")) vehicle.own_acceleration = section.number("own_acceleration", kAnyFinite);
}

}  // namespace platoon
