#include "stochastic_platoon/run/results/model_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"
#include "stochastic_platoon/run/results/age_results.hpp"
#include "stochastic_platoon/run/results/signal_results.hpp"

namespace platoon {

using Column = std::vector<double>;

const Column& number_column(const ResultTables& files, const char* file, const char* name) {
  const CsvTable& table = files.tables.at(file);
  const auto found = std::find(table.names.begin(), table.names.end(), name);
  const std::size_t at = static_cast<std::size_t>(found - table.names.begin());
  const Column* values = found == table.names.end() ? nullptr : std::get_if<Column>(&table.columns[at]);
  if (values == nullptr) throw std::invalid_argument(formatted("%s.csv: %s: must be a column of numbers", file, name));
  return *values;
}

namespace {

// Relative difference of theories computed on two machines.
constexpr double kSameTheory = 1e-6;

bool is_same(double written, double computed, double scale) {
  if (std::isnan(written) || std::isnan(computed)) return std::isnan(written) && std::isnan(computed);
  return std::abs(written - computed) <= kSameTheory * std::max(std::abs(computed), scale) || written == computed;
}

// What the recorded model has in a row of a table, and the rounding in it.
struct TheoryRow {
  double mean, variance, mean_rounding, variance_rounding;
};

// Appends a problem for the first row whose theory is not that of the recorded model.
void compare_theory(const ResultTables& files, const char* file, const std::vector<TheoryRow>& rows,
                    std::vector<std::string>& problems) {
  const Column &means = number_column(files, file, "theoretical_mean"),
               &variances = number_column(files, file, "theoretical_variance");
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const TheoryRow& of = rows[r];
    if (is_same(means[r], of.mean, std::sqrt(std::abs(of.variance)) + of.mean_rounding / kSameTheory) &&
        is_same(variances[r], of.variance, of.variance_rounding / kSameTheory))
      continue;
    return problems.push_back(formatted(
        "%s.csv: line %zu: a theoretical mean of %.9g and variance of %.9g, but the recorded model has %.9g and %.9g",
        file, r + 2, means[r], variances[r], of.mean, of.variance));
  }
}

void compare_theory(const ResultTables& files, const Configuration& configuration, const Prediction& prediction,
                    std::vector<std::string>& problems) {
  std::vector<TheoryRow> rows;
  for (std::size_t c = 0; c < prediction.mean.size(); ++c) {
    const double rounding = prediction.rounding.empty() ? 0.0 : prediction.rounding[c];
    rows.push_back({prediction.mean[c], prediction.variance[c], rounding, 0.0});
  }
  compare_theory(files, "statistics", rows, problems);
  if (files.tables.count("signals") == 0) return;
  const RunOptions& run = configuration.run;
  rows.clear();
  for (std::size_t s = 0; s < run.signals.size(); ++s) {
    for (std::size_t i = 1; i <= run.followers; ++i) {
      for (std::int64_t k = 0; k < run.steps; ++k) {
        if (prediction.signals.empty() || i > prediction.followers_with_theory) {
          rows.push_back({kNaN, kNaN, 0.0, 0.0});
          continue;
        }
        const SignalMoments& of = prediction.signals[s];
        const std::size_t c = cell(i, k, run.steps);
        const double rounding = prediction.signal_rounding[s];
        rows.push_back({of.mean[c], of.variance[c], rounding, rounding * rounding});
      }
    }
  }
  compare_theory(files, "signals", rows, problems);
}

std::string differing(const char* file, std::size_t row, const std::string& name, double written, double expected) {
  return formatted("%s.csv: line %zu: %s: %.15g: must be %.15g, by the recorded model and run", file, row + 2,
                   name.c_str(), written, expected);
}

// Appends a problem for the first row whose figure is not that of the recorded model.
void compare_column(const ResultTables& files, const char* file, const std::string& name, const Column& expected,
                    std::vector<std::string>& problems) {
  const Column& written = number_column(files, file, name.c_str());
  if (written.size() != expected.size())
    return problems.push_back(formatted("%s.csv: %zu rows: must be %zu", file, written.size(), expected.size()));
  for (std::size_t r = 0; r < expected.size(); ++r) {
    if (is_same(written[r], expected[r], 0.0)) continue;
    return problems.push_back(differing(file, r, name, written[r], expected[r]));
  }
}

// The same for the theoretical columns of a table that is formed anew.
void compare_table(const ResultTables& files, const char* file, const std::string& anew,
                   std::vector<std::string>& problems) {
  if (files.tables.count(file) == 0 || anew.empty()) return;
  const CsvTable expected = parse_csv(anew, file);
  for (std::size_t n = 0; n < expected.names.size(); ++n) {
    if (expected.names[n].rfind("theoretical_", 0) == 0)
      compare_column(files, file, expected.names[n], std::get<Column>(expected.columns[n]), problems);
  }
}

// Appends a problem for each figure in a summary that is not that of the recorded model. Texts only explain figures.
void compare_summary(const nlohmann::json& written, const nlohmann::json& expected, const std::string& path,
                     std::vector<std::string>& problems) {
  if (written.is_structured() && written.type() == expected.type() && written.size() == expected.size()) {
    for (const auto& [key, value] : expected.items())
      compare_summary(written.is_array() ? written[std::stoul(key)] : written.value(key, nlohmann::json()), value,
                      path.empty() ? key : path + "/" + key, problems);
    return;
  }
  const bool are_texts = written.is_string() && expected.is_string(),
             are_figures = written.is_number_float() && expected.is_number_float();
  if (written == expected || are_texts || (are_figures && is_same(written, expected, 0.0))) return;
  problems.push_back("summary.json: " + path + ": " + written.dump() + ": must be " + expected.dump() +
                     ", by the recorded model and run");
}

// Each row of a complete run has its place and all realizations.
void check_rows(const ResultTables& files, const Configuration& configuration, std::vector<std::string>& problems) {
  const RunOptions& run = configuration.run;
  const nlohmann::json& summary = files.summary;
  compare_summary(
      {{"followers", summary.at("followers")}, {"steps", summary.at("steps")}, {"seed", summary.at("seed")}},
      {{"followers", run.followers}, {"steps", run.steps}, {"seed", run.seed}}, "", problems);
  if (run.averaging() == Averaging::over_time || !problems.empty()) return;
  const auto steps = static_cast<std::size_t>(run.steps), of_kind = run.followers * steps;
  const auto realizations = summary.at("realizations").get<double>();
  for (const char* table : {"statistics", "signals"}) {
    if (files.tables.count(table) == 0) continue;
    for (const char* name : {"vehicle", "step", "count"}) {
      const Column& written = number_column(files, table, name);
      for (std::size_t row = 0; row < written.size(); ++row) {
        const std::size_t at = row % of_kind;
        const double expected = name == std::string("count")  ? realizations
                                : name == std::string("step") ? static_cast<double>(at % steps)
                                                              : static_cast<double>(1 + at / steps);
        if (written[row] == expected) continue;
        problems.push_back(differing(table, row, name, written[row], expected));
        break;
      }
    }
  }
}

}  // namespace

void compare_with_model(const ResultTables& files, const Configuration& configuration, const Prediction& prediction,
                        const RunResult& result, std::vector<std::string>& problems) {
  check_rows(files, configuration, problems);
  compare_theory(files, configuration, prediction, problems);
  // As it is written: NaN is null.
  const nlohmann::json written = files.summary.at("theory"),
                       expected = nlohmann::json::parse(theory_json(prediction).dump());
  if (written.at("string_stable") != expected.at("string_stable")) {
    problems.push_back("summary.json: the verdict is not that of the recorded model, which is: " +
                       prediction.stability.reason);
  } else {
    compare_summary(written, expected, "theory", problems);
  }
  if (!result.signals.empty() && configuration.run.has_amplification())
    compare_table(files, "amplification", amplification_csv(configuration, prediction, result), problems);
  if (configuration.run.averaging() == Averaging::over_realizations)
    compare_table(files, "ages", ages_csv(configuration, result), problems);
  if (files.tables.count("gaps") > 0) {
    Column bounds;
    for (std::size_t i = 1; i <= configuration.run.followers; ++i)
      bounds.push_back(collision_bound(prediction, i).value_or(kNaN));
    compare_column(files, "gaps", "theoretical_collision_bound", bounds, problems);
  }
}

}  // namespace platoon
