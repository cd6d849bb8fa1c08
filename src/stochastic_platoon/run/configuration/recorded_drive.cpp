#include "stochastic_platoon/run/configuration/recorded_drive.hpp"

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/number_table.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {

constexpr double kLongestGap = 1.0;     // [s]
constexpr double kRoundedStamp = 1e-6;  // [s], of the time since 1970 as a double: rows at 1 Hz are no gaps
constexpr double kLargestTime = 1e12, kLargestValue = 1e9;

/// The column at one time after the first row.
struct Sample {
  double second, value;
};

Sample sample_of(const NumberTable& table, const RecordedDrive& drive) {
  return {table.number(0, kLargestTime), drive.unit * table.number(1, kLargestValue)};
}

}  // namespace

std::vector<double> positions_of(const RecordedDrive& drive, double sample_period, bool steady) {
  NumberTable table(drive.file, drive.skip_rows, {drive.time, drive.value});
  if (!table.next()) table.fail("holds no rows below the column names");
  Sample before = sample_of(table, drive);
  const double first = before.second;
  double last = first;
  before.second = 0.0;
  std::vector<double> values;  // at from_second, from_second + T_s, ...
  const auto time_of = [&](std::size_t k) { return drive.from_second + static_cast<double>(k) * sample_period; };
  while (table.next()) {
    Sample sample = sample_of(table, drive);
    const double time = sample.second;
    sample.second -= first;
    const double passed = sample.second - before.second;
    if (!(passed > 0.0))
      table.fail_row(printable(drive.time) + formatted(": %.15g after %.15g: must ascend", time, last));
    if (passed > kLongestGap + kRoundedStamp)
      table.fail_row(formatted("%g s after the row before: must be at most %g s", passed, kLongestGap));
    while (time_of(values.size()) <= sample.second) {
      const double share = (time_of(values.size()) - before.second) / passed;
      values.push_back(before.value + share * (sample.value - before.value));
    }
    before = sample;
    last = time;
  }
  if (values.size() < 2)
    table.fail(
        formatted("ends %g s after its first row: must go on beyond from_second = %g s by a sample period of %g s",
                  before.second, drive.from_second, sample_period));
  std::vector<double> positions{0.0, 0.0};
  if (steady) positions[0] -= drive.is_speed ? sample_period * values[0] : values[1] - values[0];
  for (std::size_t k = 1; k < values.size(); ++k) {
    positions.push_back(drive.is_speed ? positions.back() + 0.5 * sample_period * (values[k - 1] + values[k])
                                       : values[k] - values[0]);
  }
  return positions;
}

}  // namespace platoon
