#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace platoon {

/// A table of a drive: rows of numbers below a row of column names, separated by commas, semicolons or tabs.
struct RecordedDrive {
  std::string file;
  std::string time = "time";    ///< name of the column of times [s], ascending
  std::string value = "speed";  ///< name of the column of speeds or positions
  bool is_speed = true;
  double unit = 1.0;           ///< one unit of the column in m/s, or in m
  std::int64_t skip_rows = 0;  ///< rows above the column names
  double from_second = 0.0;    ///< [s] after the first row: where the drive begins
};

/// y_0(-1), y_0(0), ... [m] of vehicle 0 along the whole table: the column is interpolated linearly at multiples of the
/// sample period [s], and speeds are integrated by the trapezoidal rule. y_0(0) = 0, and y_0(-1) = 0 or, for a steady
/// start, -V T_s with the first speed V used, or that of the first step along a column of positions.
///
/// Throws std::invalid_argument with the reason and the row unless the file can be read, has both columns, at least two
/// rows of finite numbers from from_second on, and times that ascend by at most 1 s from row to row.
std::vector<double> positions_of(const RecordedDrive& drive, double sample_period, bool steady = false);

}  // namespace platoon
