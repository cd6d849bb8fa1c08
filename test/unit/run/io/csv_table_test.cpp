#include "stochastic_platoon/run/io/csv_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/run/io/csv_text.hpp"
#include "unit/messages.hpp"

namespace platoon {
namespace {

std::string error_of(const std::string& text) {
  return message_of<std::invalid_argument>([&text] { parse_csv(text, "table.csv"); });
}

TEST(CsvTable, HasNaNForEmptyCellsInColumnsOfNumbers) {
  const CsvTable table = parse_csv("a,b\n1,0.1\n,1e-300\n-inf,\n", "table.csv");
  ASSERT_EQ(table.names, (std::vector<std::string>{"a", "b"}));
  const auto& a = std::get<std::vector<double>>(table.columns[0]);
  const auto& b = std::get<std::vector<double>>(table.columns[1]);
  EXPECT_EQ(a[0], 1.0);
  EXPECT_TRUE(std::isnan(a[1]));
  EXPECT_EQ(a[2], -HUGE_VAL);
  EXPECT_EQ(b[0], 0.1);
  EXPECT_EQ(b[1], 1e-300);
  EXPECT_TRUE(std::isnan(b[2]));
}

TEST(CsvTable, KeepsTheCellsOfColumnsWithATextAsWritten) {
  const CsvTable table = parse_csv("a,\"b,\"\"c\"\"\"\r\n1.50,\"x,y\nz\"\r\n2 m,\"\"\r\n", "table.csv");
  EXPECT_EQ(table.names[1], "b,\"c\"");
  EXPECT_EQ(std::get<std::vector<std::string>>(table.columns[0]), (std::vector<std::string>{"1.50", "2 m"}));
  EXPECT_EQ(std::get<std::vector<std::string>>(table.columns[1]), (std::vector<std::string>{"x,y\nz", ""}));
}

TEST(CsvTable, TakesNoOtherTextForANumber) {
  for (const std::string& cell : {std::string("0x10"), std::string("1 "), std::string("1\0", 2), std::string("1d5")}) {
    const CsvTable table = parse_csv("a\n1\n" + cell + "\n", "table.csv");
    EXPECT_TRUE(std::holds_alternative<std::vector<std::string>>(table.columns[0])) << cell;
  }
}

TEST(CsvTable, MayEndWithoutANewline) {
  const CsvTable table = parse_csv("a,b\n1,2\n3,", "table.csv");
  EXPECT_EQ(std::get<std::vector<double>>(table.columns[0]), (std::vector<double>{1.0, 3.0}));
}

TEST(CsvTable, NamesFileAndLineOfAnError) {
  EXPECT_EQ(error_of(""), "table.csv: is empty");
  EXPECT_EQ(error_of("a,b\n"), "table.csv: holds no rows, only its heading");
  EXPECT_EQ(error_of("a,b\n1,2\n1,2,3\n"), "table.csv: line 3 has 3 values instead of 2");
  EXPECT_EQ(error_of("a,b\n1,2\n\n"), "table.csv: line 3 has 1 values instead of 2");
  EXPECT_EQ(error_of("a,b,a\n1,2,3\n"), "table.csv: line 1, column 3: a: must be another name than those before");
}

TEST(CsvText, HasAllDigitsAndEmptyCellsForMissingNumbers) {
  CsvText csv("name,count");
  csv.add("value", "missing");
  csv.end_row();
  csv.add("gap", 3u, 0.1, std::optional<double>());
  csv.end_row();
  csv.add_if(true, "speed", -1, std::optional<double>(2.5));
  csv.add_if(false, 7.0);
  csv.end_row();
  EXPECT_EQ(csv.text(), "name,count,value,missing\ngap,3,0.10000000000000001,\nspeed,-1,2.5,\n");
  EXPECT_EQ(parse_csv(csv.text(), "table.csv").names.size(), 4u);
}

}  // namespace
}  // namespace platoon
