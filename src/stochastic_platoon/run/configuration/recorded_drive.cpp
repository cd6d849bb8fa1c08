#include "stochastic_platoon/run/configuration/recorded_drive.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

constexpr double kLongestGap = 1.0;  // [s]
constexpr double kLargestTime = 1e12, kLargestValue = 1e9;

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\""), last = text.find_last_not_of(" \t\r\"");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::string> cells_of(const std::string& line, char separator) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t end = line.find(separator, begin);
    cells.push_back(trimmed(line.substr(begin, end - begin)));
    if (end == std::string::npos) return cells;
    begin = end + 1;
  }
}

/// The rows of a drive, one after the other, with their time after the first row.
class DriveRows {
public:
  explicit DriveRows(const RecordedDrive& drive) : drive_(drive), stream_(drive.file) {
    if (!stream_) fail("must be a file that can be read");
    for (std::int64_t skipped = 0; skipped < drive.skip_rows; ++skipped) next_line();
    if (!next_line()) fail("holds no row of column names");
    for (const char separator : {'\t', ';', ','}) {
      if (line_.find(separator) != std::string::npos) {
        separator_ = separator;
        break;
      }
    }
    const std::vector<std::string> names = cells_of(line_, separator_);
    time_ = place_of(drive.time, names);
    value_ = place_of(drive.value, names);
  }

  struct Row {
    double second, value;
  };

  /// False at the end of the file.
  bool next(Row* row) {
    do {
      if (!next_line()) return false;
    } while (trimmed(line_).empty());
    const std::vector<std::string> cells = cells_of(line_, separator_);
    const double time = number(cells, time_, drive_.time, kLargestTime);
    const double value = number(cells, value_, drive_.value, kLargestValue);
    if (!has_first_) first_ = time;
    has_first_ = true;
    const double second = time - first_;
    if (has_last_ && !(second > last_)) fail_row(formatted("%s does not ascend", drive_.time.c_str()));
    if (has_last_ && second - last_ > kLongestGap)
      fail_row(formatted("%g s after the row before: must be at most %g s", second - last_, kLongestGap));
    last_ = second;
    has_last_ = true;
    *row = {second, drive_.unit * value};
    return true;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw std::invalid_argument(printable(drive_.file) + ": " + reason);
  }

private:
  bool next_line() {
    ++number_;
    return static_cast<bool>(std::getline(stream_, line_));
  }

  [[noreturn]] void fail_row(const std::string& reason) const { fail(formatted("row %lld: ", number_) + reason); }

  std::size_t place_of(const std::string& name, const std::vector<std::string>& names) const {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    std::string present;
    for (const std::string& of : names) present += (present.empty() ? "" : ", ") + of;
    fail("no column " + printable(name) + ": must be one of " + printable(shortened(present)));
  }

  double number(const std::vector<std::string>& cells, std::size_t place, const std::string& name, double most) const {
    const std::string text = place < cells.size() ? cells[place] : "";
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !(std::abs(value) <= most))
      fail_row(printable(name) + ": " + (text.empty() ? "(empty)" : printable(shortened(text))) +
               ": must be a finite number");
    return value;
  }

  const RecordedDrive& drive_;
  std::ifstream stream_;
  std::string line_;
  char separator_ = ',';
  std::size_t time_ = 0, value_ = 0;
  long long number_ = 0;  ///< of the line
  double first_ = 0.0, last_ = 0.0;
  bool has_first_ = false, has_last_ = false;
};

}  // namespace

std::vector<double> positions_of(const RecordedDrive& drive, double sample_period) {
  DriveRows rows(drive);
  DriveRows::Row before{}, row{};
  if (!rows.next(&before)) rows.fail("holds no rows below the column names");
  std::vector<double> values;  // at from_second, from_second + T_s, ...
  const auto time_of = [&](std::size_t k) { return drive.from_second + static_cast<double>(k) * sample_period; };
  while (rows.next(&row)) {
    for (double time = time_of(values.size()); time <= row.second; time = time_of(values.size())) {
      const double share = (time - before.second) / (row.second - before.second);
      values.push_back(before.value + share * (row.value - before.value));
    }
    before = row;
  }
  if (values.size() < 2)
    rows.fail(
        formatted("ends %g s after its first row: must go on beyond from_second = %g s by a sample period of %g s",
                  before.second, drive.from_second, sample_period));
  std::vector<double> positions{0.0, 0.0};
  for (std::size_t k = 1; k < values.size(); ++k) {
    positions.push_back(drive.is_speed ? positions.back() + 0.5 * sample_period * (values[k - 1] + values[k])
                                       : values[k] - values[0]);
  }
  return positions;
}

}  // namespace platoon
