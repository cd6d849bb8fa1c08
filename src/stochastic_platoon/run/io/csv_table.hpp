#pragma once

#include <string>
#include <variant>
#include <vector>

namespace platoon {

/// The columns of a CSV file with a row of names (RFC 4180), as this package writes them. A column holds numbers, NaN
/// for empty cells, if all its cells are numbers or empty; otherwise texts.
struct CsvTable {
  using Column = std::variant<std::vector<double>, std::vector<std::string>>;
  std::vector<std::string> names;
  std::vector<Column> columns;
};

/// Reads a table. `name`: the file's name in messages. Throws std::invalid_argument if the text has no row of names or
/// no row below it, if a row has another number of cells, or if a name occurs twice.
CsvTable parse_csv(const std::string& text, const std::string& name);

}  // namespace platoon
