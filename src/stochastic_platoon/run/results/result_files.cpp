#include "stochastic_platoon/run/results/result_files.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/checksum.hpp"
#include "stochastic_platoon/run/io/csv_text.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/report/json_value.hpp"
#include "stochastic_platoon/run/report/linear_theory.hpp"
#include "stochastic_platoon/run/results/age_results.hpp"
#include "stochastic_platoon/run/results/no_verdict.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"
#include "stochastic_platoon/run/results/signal_results.hpp"

namespace platoon {

namespace {

// JSON has neither infinite numbers nor NaN, and null means that nothing was compared.
double written_score(double score) {
  constexpr double kLargest = 1e9;
  return score < kLargest ? score : kLargest;  // also for NaN
}

nlohmann::json agreement_json(const std::optional<Agreement>& agreement) {
  if (!agreement) return {{"max_abs_z_mean", nullptr}, {"max_abs_z_variance", nullptr}, {"plausible_z", nullptr}};
  nlohmann::json written = {{"max_abs_z_mean", written_score(agreement->max_abs_z_mean)},
                            {"max_abs_z_variance", nullptr},
                            {"plausible_z", agreement->plausible_z}};
  if (!agreement->means_only) written["max_abs_z_variance"] = written_score(agreement->max_abs_z_variance);
  return written;
}

// The scores of the tracking errors, and under `signals` those of every signal by its name.
nlohmann::json agreements_json(const Configuration& configuration, const Prediction& prediction,
                               const RunResult& result) {
  const RunOptions& run = configuration.run;
  const std::optional<Agreement> found = measured_agreement(run, prediction, result);
  nlohmann::json all = agreement_json(found);
  const auto reason = found ? std::nullopt : reason_of_no_verdict(configuration, prediction, result);
  if (reason) all["reason"] = *reason;
  for (std::size_t s = 0; s < result.signals.size(); ++s)
    all["signals"][run.signals[s]] = agreement_json(signal_agreement(run, prediction, result, s));
  return all;
}

// Standard errors of every follower's variance at the last step.
nlohmann::json standard_errors_json(const RunOptions& run, const Prediction& prediction, const RunResult& result) {
  nlohmann::json errors = nlohmann::json::array();
  for (const ResultCell& of : ResultCells(run, prediction, result).at(run.steps - 1))
    errors.push_back(standard_error_of_variance(of));
  return errors;
}

// The largest of them over all steps.
nlohmann::json largest_standard_errors_json(const RunOptions& run, const Prediction& prediction,
                                            const RunResult& result) {
  const ResultCells cells(run, prediction, result);
  nlohmann::json errors = nlohmann::json::array();
  for (std::size_t i = 1; i <= run.followers; ++i) {
    double largest = kNaN;
    for (std::int64_t k = 0; k < std::max<std::int64_t>(run.steps, 1); ++k)
      largest = std::fmax(largest, standard_error_of_variance(cells.of(i, k)));
    errors.push_back(largest);
  }
  return errors;
}

nlohmann::json summary_json(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  const bool over_time = run.averaging() == Averaging::over_time;
  const std::uint64_t received = result.tally.positions_received;
  const double steps = over_time ? static_cast<double>(received) / static_cast<double>(run.followers + 1)
                                 : static_cast<double>(run.steps) * static_cast<double>(result.realizations);
  const double vehicle_steps = static_cast<double>(run.followers) * steps;
  const std::uint64_t expected = over_time ? received : positions_expected(run, result.realizations);
  const double seconds = result.tally.wall_seconds;
  std::optional<double> needed = realizations_needed(run, prediction, result);
  if (needed) needed = std::ceil(*needed);
  const std::optional<std::string> growth = measured_growth(configuration, prediction, result);
  return {{"version", kVersion},
          {"complete", result.complete},
          {"followers", run.followers},
          {"steps", run.steps},
          {"time_average", over_time},
          {"realizations", result.realizations},
          {"seed", run.seed},
          {"hosting", to_string(run.hosting)},
          {"attempts", result.tally.attempts},
          {"positions_received", received},
          {"positions_lost", static_cast<std::int64_t>(expected) - static_cast<std::int64_t>(received)},
          {"wall_seconds", seconds},
          {"vehicle_steps_per_second", seconds > 0.0 ? vehicle_steps / seconds : 0.0},
          {"standard_error_of_variance", standard_errors_json(run, prediction, result)},
          {"largest_standard_error_of_variance", largest_standard_errors_json(run, prediction, result)},
          {"agreement", agreements_json(configuration, prediction, result)},
          {"realizations_needed", number(needed)},
          {"theory", theory_json(prediction)},
          {"contradictions", prediction.contradictions},
          {"warnings", run_warnings(configuration, prediction, result)},
          {"measured_growth", growth ? nlohmann::json(*growth) : nlohmann::json()},
          {"warning", prediction.warning.empty() ? nlohmann::json() : nlohmann::json(prediction.warning)}};
}

}  // namespace

nlohmann::json theory_json(const Prediction& prediction) {
  nlohmann::json theory = to_json(prediction.stability);
  theory["stationary_variance"] = numbers(prediction.stationary_variance);
  if (prediction.has_theory()) return theory;
  for (const auto& [key, value] : theory.items()) {
    if (key != "reason") value = nullptr;
  }
  return theory;
}

std::string statistics_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  const ResultCells cells(run, prediction, result);
  CsvText csv("vehicle,step,count,mean,variance,theoretical_mean,theoretical_variance");
  csv.end_row();
  for (std::size_t i = 1; i <= run.followers; ++i) {
    for (std::int64_t k = 0; k < (run.averaging() == Averaging::over_time ? 1 : run.steps); ++k) {
      const ResultCell of = cells.of(i, k);
      csv.add(i, of.step, of.measured.count, of.measured.known_mean(), of.measured.variance());
      csv.add_if(i <= prediction.followers_with_theory, of.theoretical_mean, of.theoretical_variance);
      csv.end_row();
    }
  }
  return csv.text();
}

namespace {

// Replaces the summary's own checksum while that is computed.
const std::string kNoChecksum(8, '0');

// Its position: no other text of a summary matches, because quotes in strings are escaped.
std::size_t place_of_checksum(const std::string& text) {
  const std::string own = "\"summary\": \"";
  const std::size_t found = text.find(own);
  return found == std::string::npos ? found : found + own.size();
}

using Files = std::map<std::string, std::string>;  // contents by name

constexpr char kSummary[] = "summary.json";

Files tables_of(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  Files tables{{"statistics.csv", statistics_csv(configuration, prediction, result)}};
  if (!result.signals.empty()) tables["signals.csv"] = signals_csv(configuration, prediction, result);
  if (!result.signals.empty() && configuration.run.has_amplification())
    tables["amplification.csv"] = amplification_csv(configuration, prediction, result);
  if (!result.gaps.empty()) tables["gaps.csv"] = gaps_csv(configuration, prediction, result);
  if (!result.limits.empty()) tables["limits.csv"] = limits_csv(configuration, result);
  if (std::string ages = ages_csv(configuration, result); !ages.empty()) tables["ages.csv"] = std::move(ages);
  return tables;
}

bool is_whole_summary(const std::string& text) {
  const std::size_t place = place_of_checksum(text);
  if (place == std::string::npos || place + kNoChecksum.size() > text.size()) return false;
  std::string without = text;
  without.replace(place, kNoChecksum.size(), kNoChecksum);
  return text.substr(place, kNoChecksum.size()) == checksum(without);
}

void require_undamaged(bool is_undamaged, const std::string& file) {
  if (!is_undamaged) throw std::invalid_argument(file + ": is not as it was written: damaged, or changed by hand");
}

}  // namespace

std::string with_checksums(nlohmann::json summary, const std::map<std::string, std::string>& tables, int indent) {
  summary["crc32"] = {{"summary", kNoChecksum}};
  for (const auto& [name, content] : tables)
    summary["crc32"][std::filesystem::path(name).stem().string()] = checksum(content);
  std::string text = summary.dump(indent) + "\n";
  return text.replace(place_of_checksum(text), kNoChecksum.size(), checksum(text));
}

std::string unfinished_summary_file(const std::string& output) {
  return output + "/summary.unfinished.json";
}

Files result_files(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  Files files = tables_of(configuration, prediction, result);
  nlohmann::json summary = summary_json(configuration, prediction, result);
  summary.update(provenance(configuration));
  if (has_limits(configuration.model)) summary["linear"] = linear_json(configuration);
  if (!result.gaps.empty()) summary["smallest_gap"] = smallest_gap_json(result);
  std::string text = with_checksums(std::move(summary), files);
  files[kSummary] = std::move(text);
  return files;
}

void write_results(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const std::string& output = configuration.run.output;
  Files files = result_files(configuration, prediction, result);
  write_atomically(unfinished_summary_file(output), files.extract(kSummary).mapped());
  for (const auto& [name, content] : files) write_atomically(output + "/" + name, content);
  sync_and_rename(unfinished_summary_file(output), output + "/" + kSummary);
}

nlohmann::json parse_json(const std::string& text, const std::string& file,
                          const nlohmann::json::parser_callback_t& callback) {
  nlohmann::json document;
  try {
    document = nlohmann::json::parse(text, callback);
  } catch (const nlohmann::json::exception& error) {
    throw std::invalid_argument(file + ": not JSON: " + printable(error.what()));
  }
  if (!document.is_object()) throw std::invalid_argument(file + ": must be a JSON object");
  // Either, as a flipped bit may hide one.
  if (document.contains("crc32") || place_of_checksum(text) != std::string::npos)
    require_undamaged(is_whole_summary(text), file);
  return document;
}

nlohmann::json parse_summary(const std::string& text, const std::string& file) {
  nlohmann::json summary = parse_json(text, file);
  if (!summary.contains("crc32")) throw std::invalid_argument(file + ": crc32 is missing");
  return summary;
}

void require_own_table(const std::string& folder, const std::string& name) {
  const std::string summary = folder + "/" + name + ".json";
  if (may_exist(summary)) parse_summary(read_file(summary, kMostWrittenBytes), summary);
}

void write_table(const std::string& folder, const std::string& name, nlohmann::json summary, std::string csv) {
  require_own_table(folder, name);
  const std::string summary_file = folder + "/" + name + ".json";
  Files table;
  std::string& text = table[name + ".csv"] = std::move(csv);
  write_atomically(summary_file, with_checksums(std::move(summary), table));
  write_atomically(folder + "/" + name + ".csv", text);
}

CsvTable read_table(const std::string& file) {
  const std::string text = read_file(file, kMostWrittenBytes);
  const std::string name = std::filesystem::path(file).stem().string(),
                    summary = std::filesystem::path(file).replace_extension(".json").string();
  if (name != "summary" && may_exist(summary)) {
    const nlohmann::json document = parse_json(read_file(summary, kMostWrittenBytes), summary);
    const nlohmann::json sum = document.value("crc32", nlohmann::json::object()).value(name, nlohmann::json());
    require_undamaged(sum.is_null() || sum == checksum(text), file);
  }
  return parse_csv(text, file);
}

ResultTables parse_results(const std::function<std::string(const std::string&)>& read, const std::string& folder,
                           std::vector<std::string>* problems, const std::string& summary) {
  ResultTables results{parse_summary(read(summary), folder + "/" + summary), {}};
  for (const auto& [name, sum] : results.summary["crc32"].items()) {
    if (name == "summary") continue;
    try {
      const std::string table = read(name + ".csv"), table_file = folder + "/" + name + ".csv";
      require_undamaged(sum == checksum(table), table_file);
      results.tables[name] = parse_csv(table, table_file);
    } catch (const std::exception& error) {
      if (problems == nullptr) throw;
      problems->emplace_back(error.what());
    }
  }
  return results;
}

}  // namespace platoon
