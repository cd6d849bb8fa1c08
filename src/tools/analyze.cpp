// The results of the theory for a platoon, without running it: a report on the terminal; all numbers as JSON or CSV on
// request.

#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/configuration/spaced.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/report/analysis_report.hpp"
#include "stochastic_platoon/run/report/stability_map.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "tools/command_line.hpp"

namespace {

// Tables of an earlier analysis are replaced, and no other file.
void require_replaceable(const std::string& option, const std::string& file) {
  std::error_code error;
  const std::filesystem::file_type type = std::filesystem::status(file, error).type();
  if (type == std::filesystem::file_type::not_found && !file.empty()) return;
  if (type == std::filesystem::file_type::regular) {
    const std::string content = platoon::read_file(file, platoon::kMostGivenBytes);
    const nlohmann::json document = nlohmann::json::parse(content, nullptr, false);
    const bool is_analysis =
        document.is_object() && document.contains("age_of_information") && document.contains("rounding");
    if (content.empty() || (option == "json" ? is_analysis : content.rfind("headway,", 0) == 0)) return;
  }
  const std::string reason = type == std::filesystem::file_type::none ? error.message()
                             : option == "json"                       ? "exists and is no earlier analysis"
                                                                      : "exists and is no earlier map";
  throw platoon::ConfigurationError(
      {option + ": " + (file.empty() ? "(empty)" : file + ": " + reason) + ": must be another file"});
}

// The values of an option FROM:TO:COUNT; none if it is not given.
std::vector<double> values_of(const platoon::CommandLine& given, const std::string& option) {
  if (!given.has(option)) return {};
  const std::optional<platoon::Spaced> spaced = platoon::parse_spaced(given[option]);
  if (!spaced || spaced->count > 1000000)
    throw platoon::ConfigurationError({"--" + platoon::option_name(option) + ": " + given[option] +
                                       ": must be FROM:TO:COUNT with FROM <= TO and COUNT from 1 to 1000000"});
  std::vector<double> values;
  for (std::uint64_t i = 0; i < spaced->count; ++i) values.push_back(spaced->at(i));
  return values;
}

/// Shows the present computation on a terminal until it ends.
class StageDisplay {
public:
  StageDisplay() = default;
  ~StageDisplay() { show("\r\033[K"); }
  StageDisplay(const StageDisplay&) = delete;
  StageDisplay& operator=(const StageDisplay&) = delete;

  void begins(const std::string& stage) { show("\r\033[Kcomputing: " + stage); }

private:
  void show(const std::string& text) {
    if (isatty(STDERR_FILENO) == 1) std::cerr << text << std::flush;
  }
};

platoon::MapAxes map_axes(const platoon::CommandLine& given, platoon::ProblemCollector& problems) {
  const auto axis = [&](const char* option) {
    return problems.result_of([&] { return values_of(given, option); }).value_or(std::vector<double>());
  };
  return {axis("sweep_headway"), axis("sweep_gain"), axis("sweep_loss"), axis("sweep_burst")};
}

}  // namespace

int analyze_main(int argc, char** argv) {
  const platoon::CommandLine given = platoon::parse_command_line(
      argc, argv,
      {"Results of the theory for a platoon\n"
       "Example: analyze --model acc.yaml --headway-seconds 3.5",
       {"model", "followers", "headway", "headway_seconds", "noise_variance", "loss", "mean_burst", "delay", "leader",
        "steps", "burn_in"},
       {{"json", "file for all numbers"},
        {"sweep_headway", "FROM:TO:COUNT: stability over headways, in sample periods"},
        {"sweep_gain", "FROM:TO:COUNT: with --sweep-headway, over controller gains too"},
        {"sweep_loss", "FROM:TO:COUNT: stability over loss probabilities, and headways where both are given"},
        {"sweep_burst", "FROM:TO:COUNT: stability over mean bursts, and over the others given"},
        {"csv", "file for the map, for plot map"},
        {"signals",
         platoon::all_signal_names() +
             ", separated by commas: their moments beside those of the errors; with the speed its amplification"},
        {"collision_probability",
         "per step, above 0, below 0.5: collisions, and the standstill distance that keeps to it"}},
       false,
       {},
       {{"steps", platoon::kStepsHelp}, {"burn_in", "steps that the amplification of the speed leaves out (none)"}}});
  try {
    platoon::ProblemCollector problems;
    if (given.has("sweep_gain") && !given.has("sweep_headway"))
      problems.add("--sweep-gain: given: must go with --sweep-headway");
    for (const char* target : {"json", "csv"}) {
      if (given.has(target)) problems.check([&] { require_replaceable(target, given[target]); });
    }
    if (given.has("csv") && !given.has("sweep_headway") && !given.has("sweep_loss") && !given.has("sweep_burst"))
      problems.add("--csv: given: must go with --sweep-headway, --sweep-loss or --sweep-burst");
    const platoon::MapAxes axes = map_axes(given, problems);
    const auto signals =
        problems.result_of([&] { return platoon::signal_request(given["signals"], given["collision_probability"]); });
    std::map<std::string, std::string> settings = given.settings;
    settings.emplace("model", platoon::paper_model_file());
    std::cout << settings["model"] << "\n";
    const auto found =
        problems.result_of([&] { return platoon::parse_configuration(platoon::configuration_document(settings)); });
    problems.check([&] { platoon::require_steps(given, "here"); });
    problems.require_none();
    const platoon::Configuration& configuration = *found;
    const platoon::PlatoonModel& model = configuration.model;
    std::vector<platoon::MapPoint> points;
    platoon::Analysis analysis{};
    {
      StageDisplay display;
      display.begins("stability map");
      if (!axes.headways.empty() || !axes.losses.empty() || !axes.bursts.empty())
        points = platoon::stability_map(model, axes);
      analysis = platoon::analyze(configuration, *signals, [&display](const char* stage) { display.begins(stage); });
    }
    std::cout << platoon::report(configuration, analysis);
    nlohmann::json document = platoon::to_json(configuration, analysis);
    if (!points.empty()) document["sweep"] = platoon::to_json(points, model.sample_period);
    if (given.has("csv")) platoon::write_atomically(given["csv"], platoon::to_csv(points));
    if (!points.empty() && platoon::has_limits(model)) std::cout << "Stability map of the same cars without limits\n";
    if (!given.has("csv")) std::cout << platoon::report(points);
    if (given.has("json"))
      platoon::write_atomically(given["json"], platoon::with_checksums(std::move(document), {}, 1));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
