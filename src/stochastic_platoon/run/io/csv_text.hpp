#pragma once

#include <optional>
#include <string>
#include <type_traits>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

/// Writes a table that parse_csv() reads, cell by cell.
class CsvText {
public:
  CsvText() = default;
  /// Begins the row of names with these, separated by commas.
  explicit CsvText(const std::string& names) { add(names); }

  /// Adds texts without commas, whole numbers, and numbers with the 17 digits that keep their bits. A missing number is
  /// an empty cell.
  template <class... Cells>
  void add(const Cells&... cells) {
    ((text_ += text_of(cells) + ","), ...);
  }

  /// The same if they exist; otherwise as many empty cells.
  template <class... Cells>
  void add_if(bool exist, const Cells&... cells) {
    ((text_ += (exist ? text_of(cells) : "") + ","), ...);
  }

  void end_row() {
    check_interruption();
    text_.back() = '\n';
  }

  const std::string& text() const { return text_; }

private:
  static std::string text_of(const std::optional<double>& number) { return number ? text_of(*number) : ""; }

  template <class Cell>
  static std::string text_of(const Cell& cell) {
    if constexpr (std::is_integral_v<Cell>) {
      return std::to_string(cell);
    } else if constexpr (std::is_floating_point_v<Cell>) {
      return formatted("%.17g", cell);
    } else {
      return cell;
    }
  }

  std::string text_;
};

}  // namespace platoon
