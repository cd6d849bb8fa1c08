#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace platoon {

/// Reads chosen columns of a table row by row: numbers below a row of column names, separated by tabs, semicolons or
/// commas. All faults throw std::invalid_argument with the file, the row and the column.
class NumberTable {
public:
  /// skip_rows: rows above the column names. Throws unless the file is a regular one of at most kMostGivenBytes and has
  /// each of these columns once.
  NumberTable(const std::string& file, std::int64_t skip_rows, std::vector<std::string> columns);

  /// Goes to the next row that is not empty; false at the end of the file. Throws if the row has more cells than there
  /// are columns, as with a decimal comma.
  bool next();

  /// The number of this row in the j-th of the chosen columns. Throws unless the whole cell is a number_in() of at most
  /// `most` in magnitude.
  double number(std::size_t j, double most) const;

  [[noreturn]] void fail(const std::string& reason) const;
  [[noreturn]] void fail_row(const std::string& reason) const;  ///< names the row

private:
  bool next_line();

  std::string file_;
  std::vector<std::string> columns_;
  std::vector<std::size_t> places_;
  std::size_t width_ = 0;  ///< number of columns
  std::string text_;
  std::size_t at_ = 0;  ///< begin of the next row in the text
  std::string line_;
  std::vector<std::string> cells_;
  char separator_ = ',';
  long long row_ = 0;
};

}  // namespace platoon
