#include "stochastic_platoon/run/configuration/number_table.hpp"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {

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

}  // namespace

NumberTable::NumberTable(const std::string& file, std::int64_t skip_rows, std::vector<std::string> columns)
    : file_(file), columns_(std::move(columns)), stream_(file) {
  if (!stream_) fail("must be a file that can be read");
  for (std::int64_t skipped = 0; skipped < skip_rows; ++skipped) next_line();
  if (!next_line()) fail("holds no row of column names");
  for (const char separator : {'\t', ';', ','}) {
    if (line_.find(separator) == std::string::npos) continue;
    separator_ = separator;
    break;
  }
  const std::vector<std::string> names = cells_of(line_, separator_);
  for (const std::string& column : columns_) {
    const auto found = std::find(names.begin(), names.end(), column);
    if (found == names.end())
      fail("no column " + printable(column) + ": must be one of " +
           printable(shortened(boost::algorithm::join(names, ", "))));
    places_.push_back(static_cast<std::size_t>(found - names.begin()));
  }
}

bool NumberTable::next() {
  do {
    if (!next_line()) return false;
  } while (line_.find_first_not_of(" \t\r\"") == std::string::npos);
  return true;
}

bool NumberTable::next_line() {
  ++row_;
  return static_cast<bool>(std::getline(stream_, line_));
}

// Empty behind the last cell of the row.
std::string NumberTable::cell(std::size_t place) const {
  std::size_t begin = 0;
  for (; place > 0; --place) {
    begin = line_.find(separator_, begin);
    if (begin == std::string::npos) return "";
    ++begin;
  }
  return trimmed(line_.substr(begin, line_.find(separator_, begin) - begin));
}

double NumberTable::number(std::size_t j, double most) const {
  const std::string text = cell(places_.at(j));
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(std::abs(value) <= most))
    fail_row(printable(columns_[j]) + ": " + (text.empty() ? "(empty)" : printable(shortened(text))) +
             ": must be a finite number");
  return value;
}

void NumberTable::fail(const std::string& reason) const {
  throw std::invalid_argument(printable(file_) + ": " + reason);
}

void NumberTable::fail_row(const std::string& reason) const {
  fail(formatted("row %lld: ", row_) + reason);
}

}  // namespace platoon
