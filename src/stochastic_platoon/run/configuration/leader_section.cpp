#include "stochastic_platoon/run/configuration/leader_section.hpp"

#include <cstdint>
#include <stdexcept>

namespace platoon {

namespace {

LeaderProfile read_profile(Section& section, double sample_period, std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  std::vector<SpeedChange> changes;
  for (Section& entry : section.sections("speed")) {
    const std::int64_t step = entry.integer("from_step", 0, std::int64_t{1} << 46);
    changes.push_back({step, entry.number("value", kAnyFinite)});
    entry.reject_unknown_keys();
  }
  if (problems.size() > before) return LeaderProfile({}, 1.0);
  try {
    return LeaderProfile(changes, sample_period);
  } catch (const std::invalid_argument& error) {
    problems.push_back(std::string("leader/speed: ") + error.what());
    return LeaderProfile({}, 1.0);
  }
}

}  // namespace

LeaderContent read_leader(Section section, double sample_period, std::vector<std::string>& problems) {
  LeaderContent leader;
  if (section.has("positions")) {
    const Eigen::VectorXd positions = section.numbers("positions");
    leader.recorded.assign(positions.data(), positions.data() + positions.size());
    if (section.has("speed")) section.reject("speed", "given", "absent beside positions");
  } else {
    leader.profile = read_profile(section, sample_period, problems);
  }
  section.reject_unknown_keys();
  return leader;
}

}  // namespace platoon
