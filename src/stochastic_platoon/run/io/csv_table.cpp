#include "stochastic_platoon/run/io/csv_table.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {

/// The cells of one row.
using Row = std::vector<std::string_view>;

/// Reads a text row by row.
class CsvRows {
public:
  CsvRows(const std::string& text, const std::string& name) : text_(text), name_(name) {}

  // Reads the next row, valid until the one after it; false at the end. Throws unless it has `width` cells, if that is
  // not 0.
  bool next(Row& row, std::size_t width) {
    check_interruption();
    row.clear();
    quoted_.clear();
    if (at_ == text_.size()) return false;
    ++line_;
    do {
      row.push_back(cell());
    } while (at_ < text_.size() && text_[at_++] == ',');
    if (width != 0 && row.size() != width)
      throw std::invalid_argument(name_ + ": line " + std::to_string(line_) + " has " + std::to_string(row.size()) +
                                  " values instead of " + std::to_string(width));
    return true;
  }

private:
  // Goes to the comma or the line's end behind the cell.
  std::string_view cell() {
    const bool is_quoted = at_ < text_.size() && text_[at_] == '"';
    if (is_quoted) quoted_.push_back(unquoted());
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(",\n", begin), text_.size());
    if (is_quoted) return quoted_.back();
    const bool has_return = at_ > begin && text_[at_ - 1] == '\r';
    return {text_.data() + begin, at_ - begin - (has_return ? 1 : 0)};
  }

  // Two quotes stand for one.
  std::string unquoted() {
    std::string cell;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"' && (++at_ == text_.size() || text_[at_] != '"')) break;
      cell += text_[at_];
    }
    return cell;
  }

  const std::string& text_;
  const std::string& name_;
  std::size_t at_ = 0, line_ = 0;
  std::deque<std::string> quoted_;
};

// The number in a cell, NaN for an empty one; false for any other text.
bool read_number(std::string_view cell, double& value) {
  const std::optional<double> number = cell.empty() ? std::numeric_limits<double>::quiet_NaN() : number_in(cell);
  if (number) value = *number;
  return number.has_value();
}

}  // namespace

CsvTable parse_csv(const std::string& text, const std::string& name) {
  CsvTable table;
  Row row;
  CsvRows rows(text, name);
  if (!rows.next(row, 0)) throw std::invalid_argument(name + ": is empty");
  table.names.assign(row.begin(), row.end());
  const std::size_t width = table.names.size();
  std::set<std::string> seen;
  for (std::size_t j = 0; j < width; ++j) {
    if (!seen.insert(table.names[j]).second)
      throw std::invalid_argument(name + ": line 1, column " + std::to_string(j + 1) + ": " +
                                  printable(shortened(table.names[j])) + ": must be another name than those before");
  }

  std::vector<std::vector<double>> numbers(width);
  std::vector<bool> are_numbers(width, true);
  double value = 0.0;
  while (rows.next(row, width)) {
    for (std::size_t j = 0; j < width; ++j) {
      are_numbers[j] = are_numbers[j] && read_number(row[j], value);
      if (are_numbers[j]) numbers[j].push_back(value);
    }
  }
  std::vector<std::vector<std::string>> texts(width);
  CsvRows again(text, name);
  for (again.next(row, width); again.next(row, width);) {
    for (std::size_t j = 0; j < width; ++j) {
      if (!are_numbers[j]) texts[j].emplace_back(row[j]);
    }
  }
  for (std::size_t j = 0; j < width; ++j) {
    if (are_numbers[j] && numbers[j].empty()) throw std::invalid_argument(name + ": holds no rows, only its heading");
    if (are_numbers[j]) {
      table.columns.emplace_back(std::move(numbers[j]));
    } else {
      table.columns.emplace_back(std::move(texts[j]));
    }
  }
  return table;
}

}  // namespace platoon
