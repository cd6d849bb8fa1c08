#include "stochastic_platoon/run/results/result_check.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/model_comparison.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"

namespace platoon {

namespace {

using Column = std::vector<double>;

// As measured, without fourth moments.
std::vector<Moments> moments_in(const ResultTables& files, const char* file, std::size_t cells) {
  const Column &counts = number_column(files, file, "count"), &means = number_column(files, file, "mean"),
               &variances = number_column(files, file, "variance");
  if (counts.size() != cells)
    throw std::invalid_argument(
        formatted("%s.csv: %zu rows: must be %zu, by its followers, steps and signals", file, counts.size(), cells));
  std::vector<Moments> all;
  for (std::size_t c = 0; c < cells; ++c) {
    const auto count = static_cast<std::uint64_t>(counts[c]);
    all.push_back({count, means[c], count > 1 ? variances[c] * (counts[c] - 1.0) : 0.0});
  }
  return all;
}

RunResult result_in(const ResultTables& files, const Configuration& configuration) {
  RunResult result;
  result.complete = files.summary.at("complete").get<bool>();
  result.realizations = files.summary.at("realizations").get<std::uint64_t>();
  result.tally.attempts = files.summary.at("attempts").get<std::uint32_t>();
  const RunOptions& run = configuration.run;
  const auto cells = run.followers * static_cast<std::size_t>(run.averaging() == Averaging::over_time ? 1 : run.steps);
  result.moments = moments_in(files, "statistics", cells);
  for (const double step : number_column(files, "statistics", "step"))
    result.last_steps.push_back(static_cast<std::int64_t>(step));
  if (files.tables.count("signals") == 0) return result;
  const std::vector<Moments> all = moments_in(files, "signals", run.signals.size() * cells);
  for (auto of = all.begin(); of != all.end(); of += static_cast<std::ptrdiff_t>(cells))
    result.signals.emplace_back(of, of + static_cast<std::ptrdiff_t>(cells));
  return result;
}

// Appends a problem if the scores are not plausible.
void judge(const std::string& source, const Agreement& found, std::vector<std::string>& problems) {
  if (found.agrees()) return;
  if (found.means_only)
    return problems.push_back(
        formatted("measurement and theory disagree by %s: largest |z| %.2f of the means: must be at most %.2f",
                  source.c_str(), found.max_abs_z_mean, found.plausible_z));
  problems.push_back(formatted(
      "measurement and theory disagree by %s: largest |z| %.2f for the means and %.2f for the variances: must be at most %.2f",
      source.c_str(), found.max_abs_z_mean, found.max_abs_z_variance, found.plausible_z));
}

std::optional<Agreement> recorded_agreement(const nlohmann::json& of) {
  if (of.at("max_abs_z_mean").is_null()) return std::nullopt;
  const bool means_only = of.at("max_abs_z_variance").is_null();
  return Agreement{of.at("max_abs_z_mean").get<double>(), means_only ? kNaN : of.at("max_abs_z_variance").get<double>(),
                   of.at("plausible_z").get<double>(), means_only};
}

void check_delivery(const nlohmann::json& summary, const Configuration& configuration,
                    std::vector<std::string>& problems) {
  const RunOptions& run = configuration.run;
  const bool is_endless = run.averaging() == Averaging::over_time;
  const auto measured = summary.at("realizations").get<std::uint64_t>();
  if (!summary.at("complete").get<bool>() || (!is_endless && measured < run.realizations - run.first_realization)) {
    problems.push_back(is_endless ? "not complete: the run is endless and was stopped"
                                  : formatted("not complete: %llu of %llu realizations",
                                              static_cast<unsigned long long>(measured),
                                              static_cast<unsigned long long>(run.realizations)));
  }
  if (const auto lost = summary.at("positions_lost").get<long long>(); lost != 0)
    problems.push_back(formatted("positions_lost: %lld: must be 0 positions missing from the statistics", lost));
}

void check_figures(const ResultTables& files, const Configuration& configuration, std::vector<std::string>& problems) {
  const nlohmann::json& summary = files.summary;
  const Prediction prediction = predict(configuration);
  const RunResult result = result_in(files, configuration);
  compare_with_model(files, configuration, prediction, result, problems);
  const nlohmann::json& agreement = summary.at("agreement");
  if (const auto recorded = recorded_agreement(agreement)) judge("the scores of summary.json", *recorded, problems);
  const nlohmann::json of_signals = agreement.value("signals", nlohmann::json::object());
  for (const auto& [name, of] : of_signals.items()) {
    if (const auto recorded = recorded_agreement(of))
      judge("the scores of summary.json for the " + in_words(name), *recorded, problems);
  }
  std::vector<std::string> contradicting = summary.at("contradictions");
  std::optional<std::string> growth;
  if (!summary.at("measured_growth").is_null()) growth = summary.at("measured_growth").get<std::string>();
  if (has_normal_errors(configuration.model)) {  // else the standard errors need moments that the table lacks
    if (const auto found = measured_agreement(configuration.run, prediction, result))
      judge("the table", *found, problems);
    for (std::size_t s = 0; s < result.signals.size(); ++s) {
      if (const auto found = signal_agreement(configuration.run, prediction, result, s))
        judge("the table for the " + in_words(configuration.run.signals[s]), *found, problems);
    }
    growth = measured_growth(configuration, prediction, result);
  }
  if (contradicting.empty()) contradicting = prediction.contradictions;
  for (const std::string& text : contradicting)
    problems.push_back("figures of the theory contradict each other: " + text);
  if (growth) problems.push_back("measurement and verdict disagree: " + *growth);
}

// What was compared of a run whose tracking errors were not, and why these were not.
std::string not_compared(const nlohmann::json& agreement) {
  std::string text = "not compared with a theory", signals;
  if (agreement.contains("reason"))
    text = "tracking errors not compared with the theory (" + agreement.at("reason").get<std::string>() + ")";
  const nlohmann::json of_signals = agreement.value("signals", nlohmann::json::object());
  for (const auto& [name, of] : of_signals.items()) {
    if (recorded_agreement(of)) signals += (signals.empty() ? ", signals in agreement (" : ", ") + in_words(name);
  }
  return text + signals + (signals.empty() ? "" : ")");
}

std::string passed(const nlohmann::json& summary, const RunOptions& run) {
  const std::optional<Agreement> found = recorded_agreement(summary.at("agreement"));
  const nlohmann::json& stable = summary.at("theory").at("string_stable");
  const char* const verdict = stable.is_null()     ? "no verdict"
                              : stable.get<bool>() ? "string stable"
                                                   : "not string stable";
  // Theory ends before the first external vehicle.
  const std::string compared =
      run.external.empty() ? "" : formatted(" up to follower %zu", run.followers_before_external());
  const auto realizations = summary.at("realizations").get<std::uint64_t>();
  const std::string part = part_of_run(run, realizations);
  return formatted(
      "%s; complete, undamaged, %s: %llu followers, %lld steps, %llu realizations%s, seed %llu", verdict,
      found ? ((found->means_only ? "means in agreement" : "in agreement") + compared + largest_score(*found)).c_str()
            : not_compared(summary.at("agreement")).c_str(),
      summary.at("followers").get<unsigned long long>(), summary.at("steps").get<long long>(),
      static_cast<unsigned long long>(realizations), part.empty() ? "" : (" (a part of the run, " + part + ")").c_str(),
      summary.at("seed").get<unsigned long long>());
}

// Throws std::invalid_argument for the folder of a run that was stopped or killed before it had results.
void require_results(const std::string& folder) {
  if (std::error_code error; may_exist(folder + "/summary.json") || !std::filesystem::is_directory(folder, error))
    return;
  for (const char* file : {"rare.csv", "sweep.csv", "tune.json"}) {
    if (may_exist(folder + "/" + file))
      throw std::invalid_argument(std::string("holds ") + file +
                                  ": must be the results of a run, as only these are judged");
  }
  const std::optional<Checkpoint> found = read_checkpoint(folder);
  if (!found)
    throw std::invalid_argument("not complete: nothing was measured (neither a summary.json nor a checkpoint)");
  throw std::invalid_argument("not complete: " + extent_of(*found) + " in its checkpoint" +
                              (found->shard.is_null() ? "; resume:=true continues" : ", of a shard"));
}

}  // namespace

ResultCheck check_results(const std::string& folder) {
  require_results(folder);
  ResultCheck check;
  const ResultTables files =
      parse_results([&](const std::string& name) { return read_file(folder + "/" + name, kMostWrittenBytes); }, folder,
                    &check.problems);
  const nlohmann::json& summary = files.summary;
  if (const std::string version = summary.value("version", "(none)"); version != kVersion)
    throw std::invalid_argument(folder + "/summary.json: version: " + version + ": must be " + kVersion +
                                ", this program's: use the program of that version");
  const Configuration configuration = recorded_configuration(summary.at("configuration"));
  check_delivery(summary, configuration, check.problems);
  if (files.tables.count("statistics") > 0)
    check_figures(files, configuration, check.problems);
  else if (check.problems.empty())
    check.problems.push_back("statistics.csv: no checksum in summary.json");
  if (check.problems.empty()) check.passed = passed(summary, configuration.run);
  return check;
}

}  // namespace platoon
