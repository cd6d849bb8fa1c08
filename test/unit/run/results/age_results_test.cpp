#include "stochastic_platoon/run/results/age_results.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "stochastic_platoon/math/channel/information_age.hpp"
#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/run/io/csv_table.hpp"
#include "unit/run/results/result_with.hpp"

namespace platoon {
namespace {

class AgeResults : public ResultTest {
protected:
  std::vector<double> counts(const RunResult& result) const {
    CsvTable table = parse_csv(ages_csv(configuration_, result), "ages.csv");
    const auto column = std::find(table.names.begin(), table.names.end(), "count") - table.names.begin();
    return std::get<std::vector<double>>(table.columns[static_cast<std::size_t>(column)]);
  }
};

TEST_F(AgeResults, OfAnEndlessRunAreThoseOfItsLatestAttempt) {
  make_endless();
  const LossModel loss{0.3};
  lose_packets(loss);
  RunResult result = result_over_time();
  for (const std::uint32_t attempts : {1u, 3u}) {
    result.tally.attempts = attempts;
    std::vector<double> expected;
    for (const std::uint32_t vehicle : {1u, 2u}) {
      for (const std::uint64_t count :
           count_ages(loss, configuration_.run.seed, input_stream(vehicle, 0), 1, result.last_step, attempts - 1))
        expected.push_back(static_cast<double>(count));
    }
    EXPECT_EQ(counts(result), expected) << attempts;
  }
}

}  // namespace
}  // namespace platoon
