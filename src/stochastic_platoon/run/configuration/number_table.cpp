#include "stochastic_platoon/run/configuration/number_table.hpp"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"

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
    : file_(file), columns_(std::move(columns)) {
  try {
    text_ = read_file(file, kMostGivenBytes);
  } catch (const UnreadableFile& error) {
    throw std::invalid_argument(printable(error.what()));
  }
  if (text_.compare(0, 8, "#ROSBAG ") == 0)
    fail("a bag: must be a table of numbers; recorded_drive writes the speed of a bag's car as one");
  if (text_.compare(0, 3, "\xEF\xBB\xBF") == 0) at_ = 3;  // the mark that spreadsheets put before UTF-8
  for (std::int64_t skipped = 0; skipped < skip_rows; ++skipped) next_line();
  if (!next_line()) fail("holds no row of column names");
  for (const char separator : {'\t', ';', ','}) {
    if (line_.find(separator) == std::string::npos) continue;
    separator_ = separator;
    break;
  }
  const std::vector<std::string> names = cells_of(line_, separator_);
  width_ = names.size();
  for (const std::string& column : columns_) {
    const auto found = std::find(names.begin(), names.end(), column);
    if (found == names.end())
      fail("no column " + printable(column) + ": must be one of " +
           printable(shortened(boost::algorithm::join(names, ", "))));
    const auto again = std::find(found + 1, names.end(), column);
    if (again != names.end())
      fail_row(formatted("columns %td and %td are ", found - names.begin() + 1, again - names.begin() + 1) +
               printable(column) + ": must be one");
    places_.push_back(static_cast<std::size_t>(found - names.begin()));
  }
}

bool NumberTable::next() {
  do {
    if (!next_line()) return false;
  } while (line_.find_first_not_of(" \t\r\"") == std::string::npos);
  cells_ = cells_of(line_, separator_);
  while (cells_.size() > width_ && cells_.back().empty()) cells_.pop_back();  // behind a trailing separator
  if (cells_.size() > width_)
    fail_row(formatted("%zu cells: must be at most %zu, the number of columns", cells_.size(), width_));
  return true;
}

bool NumberTable::next_line() {
  ++row_;
  if (at_ == text_.size()) return false;
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  line_ = text_.substr(at_, end - at_);
  at_ = std::min(end + 1, text_.size());
  return true;
}

double NumberTable::number(std::size_t j, double most) const {
  const std::size_t place = places_.at(j);
  const std::string text = place < cells_.size() ? cells_[place] : "";
  const std::optional<double> value = number_in(text);
  if (!value || !(std::abs(*value) <= most))
    fail_row(printable(columns_[j]) + ": " + (text.empty() ? "(empty)" : printable(shortened(text))) + ": must be " +
             (value && std::isfinite(*value) ? formatted("at most %g in magnitude", most) : "a finite number") +
             (text.find(',') == std::string::npos ? "" : " with a decimal point"));
  return *value;
}

void NumberTable::fail(const std::string& reason) const {
  throw std::invalid_argument(printable(file_) + ": " + reason);
}

void NumberTable::fail_row(const std::string& reason) const {
  fail(formatted("row %lld: ", row_) + reason);
}

}  // namespace platoon
