// The results of the theory for a platoon, without running it: a report on the terminal; all numbers as JSON or CSV on
// request.

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <limits>
#include <mutex>
#include <thread>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/configuration/spaced.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/report/analysis.hpp"
#include "stochastic_platoon/run/report/stability_sweep.hpp"
#include "tools/settings.hpp"

namespace {

// The allowed values of FROM and TO: [least, below).
struct Range {
  double least, below;
  const char* text;
};
const Range kAboveZero{std::numeric_limits<double>::min(), 1e300, "0 < FROM"};
const Range kProbability{0.0, 1.0, "0 <= FROM"};
const Range kBurst{1.0, 1e300, "1 <= FROM"};

// FROM:TO:COUNT as COUNT equally spaced values. Throws ConfigurationError naming the option.
std::vector<double> values_of(const std::string& option, const std::string& text, const Range& range) {
  const std::optional<platoon::Spaced> spaced = platoon::parse_spaced(text);
  if (!spaced || !(spaced->from >= range.least) || !(spaced->to < range.below) || spaced->count > 1000000) {
    throw platoon::ConfigurationError({option + ": " + text + ": must be FROM:TO:COUNT with " + range.text + " <= TO" +
                                       (range.below == 1.0 ? " < 1" : "") + " and 1 <= COUNT"});
  }
  std::vector<double> values;
  for (std::uint64_t i = 0; i < spaced->count; ++i) values.push_back(spaced->at(i));
  return values;
}

/// Shows the present computation on a terminal, from half a second on.
class StageDisplay {
public:
  StageDisplay() {
    if (isatty(STDERR_FILENO) == 1) thread_ = std::thread([this] { show(); });
  }
  ~StageDisplay() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ended_ = true;
    }
    changed_.notify_one();
    if (thread_.joinable()) thread_.join();
  }
  StageDisplay(const StageDisplay&) = delete;
  StageDisplay& operator=(const StageDisplay&) = delete;

  void begins(const char* stage) {
    const std::lock_guard<std::mutex> lock(mutex_);
    stage_ = stage;
  }

private:
  void show() {
    const auto began = std::chrono::steady_clock::now();
    std::unique_lock<std::mutex> lock(mutex_);
    if (changed_.wait_for(lock, std::chrono::milliseconds(500), [this] { return ended_; })) return;
    do {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - began;
      std::fprintf(stderr, "\r\033[Kcomputing: %s (%.0f s)", stage_, passed.count());
    } while (!changed_.wait_for(lock, std::chrono::milliseconds(200), [this] { return ended_; }));
    std::fputs("\r\033[K", stderr);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  const char* stage_ = "model";
  bool ended_ = false;
  std::thread thread_;
};

void write(const std::string& file, const std::string& content) {
  platoon::write_atomically(std::filesystem::absolute(file).string(), content);
}

std::vector<platoon::SweepPoint> run_sweep(const platoon::PlatoonModel& model,
                                           const std::map<std::string, std::string>& own) {
  const auto axis = [&own](const char* name, const std::string& option, const Range& range) {
    return own.count(name) > 0 ? values_of(option, own.at(name), range) : std::vector<double>();
  };
  const platoon::SweepAxes axes{
      axis("sweep_headway", "--sweep-headway", kAboveZero), axis("sweep_gain", "--sweep-gain", kAboveZero),
      axis("sweep_loss", "--sweep-loss", kProbability), axis("sweep_burst", "--sweep-burst", kBurst)};
  if (axes.headways.empty() && axes.losses.empty() && axes.bursts.empty()) return {};
  return platoon::sweep(model, axes);
}

// "-" for a missing value, as for an unstable vehicle.
std::string column(double value) {
  return std::isnan(value) ? "           -" : platoon::formatted(" %11.9g", value);
}

void print(const std::vector<platoon::SweepPoint>& points) {
  const bool lossy = points.front().loss.has_value(), in_bursts = points.front().burst.has_value();
  std::cout << "\n   headway        gain" << (lossy ? "        loss" : "") << (in_bursts ? "  mean burst" : "")
            << "      rho(A)    peak |T|" << (lossy ? "   loss gain" : "") << "   string stable\n";
  for (const platoon::SweepPoint& point : points) {
    std::cout << platoon::formatted("%10.6g", point.headway) << column(point.gain);
    if (lossy) std::cout << column(*point.loss);
    if (in_bursts) std::cout << column(*point.burst);
    std::cout << column(point.stability.spectral_radius) << column(point.stability.peak_gain);
    if (lossy) std::cout << column(point.stability.loss_gain.value_or(std::nan("")));
    const std::optional<bool> stable = point.stability.decision();
    std::cout << "   " << (!stable ? "undecided" : *stable ? "yes" : "no") << "\n";
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string, std::string> extra = {
      {"json", "file for all numbers"},
      {"sweep_headway", "FROM:TO:COUNT: stability over headways"},
      {"sweep_gain", "FROM:TO:COUNT: with --sweep-headway, over controller gains too"},
      {"sweep_loss", "FROM:TO:COUNT: stability over loss probabilities, and headways where both are given"},
      {"sweep_burst", "FROM:TO:COUNT: stability over mean bursts, and over the others given"},
      {"csv", "file for the sweep, for plot map"},
      {"signals",
       "gap, speed, acceleration, jerk, separated by commas: their moments beside those of the errors; with the speed its amplification"},
      {"collision_probability", "per step: collisions, and the standstill distance that keeps to it"},
  };
  std::map<std::string, std::string> settings =
      platoon::parse_command_line(argc, argv, "Results of the theory for a platoon",
                                  {"model", "followers", "headway", "headway_seconds", "noise_variance", "loss",
                                   "mean_burst", "delay", "leader", "steps", "burn_in"},
                                  extra);
  std::map<std::string, std::string> own;
  for (const auto& entry : extra) {
    if (settings.count(entry.first) > 0) own[entry.first] = settings[entry.first];
    settings.erase(entry.first);
  }
  try {
    for (const char* option : {"sweep_gain", "csv"}) {
      const bool by_loss =
          option == std::string("csv") && (own.count("sweep_loss") > 0 || own.count("sweep_burst") > 0);
      if (own.count(option) == 0 || own.count("sweep_headway") > 0 || by_loss) continue;
      throw platoon::ConfigurationError({std::string(option) + ": given: must go with --sweep-headway" +
                                         (option == std::string("csv") ? ", --sweep-loss or --sweep-burst" : "")});
    }
    const platoon::SignalRequest signals = platoon::signal_request(own["signals"], own["collision_probability"]);
    settings.emplace("model", platoon::paper_model_file());
    std::cout << settings["model"] << "\n";
    const platoon::Configuration configuration =
        platoon::parse_configuration(platoon::configuration_document(settings));
    const platoon::PlatoonModel& model = configuration.model;
    std::vector<platoon::SweepPoint> points;
    platoon::Analysis analysis{};
    {
      StageDisplay display;
      display.begins("sweep");
      points = run_sweep(model, own);
      analysis = platoon::analyze(configuration, signals, [&display](const char* stage) { display.begins(stage); });
    }
    std::cout << platoon::report(configuration, analysis);
    nlohmann::json document = platoon::to_json(configuration, analysis);
    if (!points.empty()) document["sweep"] = platoon::to_json(points);
    if (own.count("csv") > 0) write(own["csv"], platoon::to_csv(points));
    if (!points.empty() && own.count("csv") == 0) print(points);
    if (own.count("json") > 0) write(own["json"], document.dump(1) + "\n");
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
