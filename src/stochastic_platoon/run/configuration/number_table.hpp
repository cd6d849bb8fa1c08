#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace platoon {

/// Reads chosen columns of a table row by row: numbers below a row of column names, separated by tabs, semicolons or
/// commas. All faults throw std::invalid_argument with the file, and from the first row of numbers on with the row.
class NumberTable {
public:
  /// skip_rows: rows above the column names. Throws unless the file can be read and has all these columns.
  NumberTable(const std::string& file, std::int64_t skip_rows, std::vector<std::string> columns);

  /// Goes to the next row that is not empty; false at the end of the file.
  bool next();

  /// The number of this row in the j-th of the chosen columns. Throws unless its magnitude is at most `most`.
  double number(std::size_t j, double most) const;

  [[noreturn]] void fail(const std::string& reason) const;
  [[noreturn]] void fail_row(const std::string& reason) const;  ///< names the row

private:
  bool next_line();
  std::string cell(std::size_t place) const;

  std::string file_;
  std::vector<std::string> columns_;
  std::vector<std::size_t> places_;
  std::ifstream stream_;
  std::string line_;
  char separator_ = ',';
  long long row_ = 0;
};

}  // namespace platoon
