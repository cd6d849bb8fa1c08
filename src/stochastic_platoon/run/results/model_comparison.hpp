#pragma once

#include <string>
#include <vector>

#include "stochastic_platoon/run/report/prediction.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"

namespace platoon {

/// A column of numbers of a table. Throws std::invalid_argument if it is none.
const std::vector<double>& number_column(const ResultTables& files, const char* file, const char* name);

/// Compares the files of a run with its recorded model: the theory in all tables and in the summary with that of the
/// prediction, places and counts of the rows of a complete run with its followers, steps and realizations. Appends a
/// problem per column and per figure, by its first difference. `result`: the measurement in the files.
void compare_with_model(const ResultTables& files, const Configuration& configuration, const Prediction& prediction,
                        const RunResult& result, std::vector<std::string>& problems);

}  // namespace platoon
