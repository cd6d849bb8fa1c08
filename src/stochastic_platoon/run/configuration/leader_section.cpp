#include "stochastic_platoon/run/configuration/leader_section.hpp"

#include <cstdint>
#include <map>
#include <stdexcept>

#include "stochastic_platoon/run/configuration/recorded_drive.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"

namespace platoon {

namespace {

LeaderProfile read_profile(Section& section, double sample_period) {
  const std::size_t before = section.problems();
  std::vector<SpeedChange> changes;
  for (Section& entry : section.sections("speed")) {
    const std::int64_t step = entry.integer("from_step", 0, std::int64_t{1} << 46);
    changes.push_back({step, entry.number("value", kAnyFinite)});
    entry.reject_unknown_keys();
  }
  if (section.problems() > before) return LeaderProfile({}, 1.0);
  try {
    return LeaderProfile(changes, sample_period);
  } catch (const std::invalid_argument& error) {
    section.report(std::string("speed: ") + error.what());
    return LeaderProfile({}, 1.0);
  }
}

// The units of a column, in m/s or m.
const std::map<std::string, double> kSpeedUnits{{"m/s", 1.0}, {"km/h", 1.0 / 3.6}, {"mph", 0.44704}},
    kLengthUnits{{"m", 1.0}, {"km", 1000.0}, {"ft", 0.3048}};

std::vector<double> read_drive(Section& section, double sample_period, bool steady) {
  const std::size_t before = section.problems();
  RecordedDrive drive;
  drive.file = section.text("file");
  const std::string column = "the name of a column, beside file";
  if (section.has("time")) drive.time = section.text("time", column);
  drive.is_speed = !section.has("position");
  if (!drive.is_speed) drive.value = section.text("position", column);
  if (!drive.is_speed && section.has("speed")) section.reject("speed", "given", "absent beside position");
  if (drive.is_speed && section.has("speed")) drive.value = section.text("speed", column);
  const std::map<std::string, double>& units = drive.is_speed ? kSpeedUnits : kLengthUnits;
  if (section.has("unit")) {
    std::vector<std::string> names;
    names.reserve(units.size());
    for (const auto& unit : units) names.push_back(unit.first);
    drive.unit = units.at(section.choice("unit", names));
  }
  if (section.has("skip_rows")) drive.skip_rows = section.integer("skip_rows", 0, 1000000);
  if (section.has("from_second")) drive.from_second = section.number("from_second", kNotNegative);
  if (section.problems() > before) return {};
  if (!may_exist(drive.file)) {
    section.reject("file", printable(drive.file) + ": no such file",
                   "a table of a drive, or one of the shipped " + shipped_names("config/leaders"));
    return {};
  }
  try {
    return positions_of(drive, sample_period, steady);
  } catch (const std::invalid_argument& error) {
    section.report(std::string("file: ") + error.what());
    return {};
  }
}

}  // namespace

LeaderContent read_leader(Section section, double sample_period, bool steady) {
  LeaderContent leader;
  if (section.has("file")) {
    leader.recorded = read_drive(section, sample_period, steady);
    if (section.has("positions")) section.reject("positions", "given", "absent beside file");
  } else if (section.has("positions")) {
    const Eigen::VectorXd positions = section.numbers("positions");
    leader.recorded.assign(positions.data(), positions.data() + positions.size());
    if (section.has("speed")) section.reject("speed", "given", "absent beside positions");
  } else {
    leader.profile = read_profile(section, sample_period);
  }
  section.reject_unknown_keys();
  return leader;
}

}  // namespace platoon
