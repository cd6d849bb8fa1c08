#include "stochastic_platoon/run/scaling/sweep_results.hpp"

#include <algorithm>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/io/digest.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/signal_results.hpp"

namespace platoon {

namespace {

constexpr char kPointFormat[] = "stochastic_platoon sweep point 1";

std::string line_of(std::uint64_t digest) {
  return formatted("%016llx\n", static_cast<unsigned long long>(digest));
}

// Digest of all inputs of a point's rows.
std::uint64_t identity_of(const Sweep& sweep, std::uint64_t point) {
  const Configuration configuration = sweep.configuration(point);
  const nlohmann::json identity = {statistics_identity(configuration),
                                   configuration.run.realizations,
                                   sweep_heading(sweep),
                                   sweep.name_of(point),
                                   sweep.all_followers,
                                   sweep.all_steps};
  return digest(identity.dump());
}

// "1", "0", or empty without a verdict.
std::string truth_column(const std::optional<bool>& value) {
  return value ? *value ? "1" : "0" : "";
}

// The signals of all points: no axis varies them.
std::vector<std::string> signals_of(const Sweep& sweep) {
  const YAML::Node signals = sweep.shared["run"]["signals"];
  return signals && signals.IsScalar() ? signal_names(signals.Scalar()) : std::vector<std::string>();
}

void add_signals(CsvText& csv, const Configuration& configuration, const Prediction& prediction,
                 const RunResult& result, std::size_t follower, std::int64_t step) {
  const std::size_t c = cell(follower, step, configuration.run.steps);
  for (std::size_t s = 0; s < result.signals.size(); ++s) {
    const Moments& of = result.signals[s][c];
    csv.add(of.mean, of.variance());
    add_signal_theory(csv, prediction, s, follower, c);
  }
  if (result.gaps.empty()) return;
  const FollowerGaps& gaps = result.gaps.followers()[follower - 1];
  csv.add(gaps.smallest.gap, gaps.collisions, collision_bound(prediction, follower));
}

}  // namespace

std::string sweep_heading(const Sweep& sweep) {
  CsvText csv("point");
  for (const SweepAxis& axis : sweep.axes) csv.add(axis.name);
  csv.add("vehicle,step,count,mean,mean_standard_error,variance,variance_standard_error");
  csv.add("theoretical_mean,theoretical_variance,string_stable,agrees");
  const std::vector<std::string> signals = signals_of(sweep);
  for (const std::string& name : signals)
    csv.add(name + "_mean", name + "_variance", "theoretical_" + name + "_mean", "theoretical_" + name + "_variance");
  const bool has_gap = std::find(signals.begin(), signals.end(), kGap) != signals.end();
  if (has_gap) csv.add("smallest_gap,collisions,theoretical_collision_bound");
  csv.end_row();
  return csv.text();
}

std::string sweep_rows(const Sweep& sweep, std::uint64_t point, const Configuration& configuration,
                       const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  const bool known = prediction.has_theory();
  std::vector<std::string> words;
  for (const YAML::Node& value : sweep.values(point)) words.push_back(word_of(value));
  std::optional<bool> stable, agrees;
  if (known) stable = prediction.stability.decision();
  if (const std::optional<Agreement> found = measured_agreement(run, prediction, result)) agrees = found->agrees();
  for (std::size_t s = 0; s < result.signals.size(); ++s) {
    const std::optional<Agreement> found = signal_agreement(run, prediction, result, s);
    if (found && !found->agrees()) agrees = false;
  }
  const ResultCells cells(run, prediction, result);
  CsvText csv;
  for (std::size_t i = sweep.all_followers ? 1 : run.followers; i <= run.followers; ++i) {
    for (std::int64_t k = sweep.all_steps ? 0 : run.steps - 1; k < run.steps; ++k) {
      const ResultCell of = cells.of(i, k);
      csv.add(point);
      for (const std::string& word : words) csv.add(word);
      csv.add(i, k, of.measured.count, of.measured.mean, standard_error_of_mean(of), of.measured.variance(),
              standard_error_of_variance(of));
      csv.add_if(known, of.theoretical_mean, of.theoretical_variance);
      csv.add(truth_column(stable), truth_column(agrees));
      add_signals(csv, configuration, prediction, result, i, k);
      csv.end_row();
    }
  }
  return csv.text();
}

std::string point_file(const std::string& output, std::uint64_t point) {
  return output + formatted("/points/%06llu.csv", static_cast<unsigned long long>(point));
}

std::string shard_folder(const std::string& output, std::uint64_t point, std::uint64_t shard) {
  return output + formatted("/points/%06llu/shard-%llu", static_cast<unsigned long long>(point),
                            static_cast<unsigned long long>(shard));
}

std::string point_content(const Sweep& sweep, std::uint64_t point, const std::string& rows) {
  const std::string content = line_of(identity_of(sweep, point)) + rows;
  return kPointFormat + std::string("\n") + line_of(digest(content)) + content;
}

std::optional<std::string> read_point(const Sweep& sweep, const std::string& output, std::uint64_t point,
                                      std::string* damage) {
  const std::string file = point_file(output, point);
  if (!may_exist(file)) return std::nullopt;
  const std::string bytes = read_file(file, kMostWrittenBytes);
  const std::string format = kPointFormat + std::string("\n"), any_line = line_of(0);
  const std::size_t heading = format.size() + any_line.size();
  const std::string content = bytes.size() < heading ? "" : bytes.substr(heading);
  if (bytes.compare(0, heading, format + line_of(digest(content))) != 0 || content.size() < any_line.size()) {
    *damage = file + ": is not as it was written";
    return std::nullopt;
  }
  if (content.compare(0, any_line.size(), line_of(identity_of(sweep, point))) != 0) {
    throw ConfigurationError({"output: " + file + ": is of another sweep than point " + std::to_string(point) + " (" +
                              sweep.name_of(point) + ") of this one: must be another folder"});
  }
  return content.substr(any_line.size());
}

void write_sweep(const Sweep& sweep, const std::string& output) {
  std::string text = sweep_heading(sweep);
  for (std::uint64_t point = 0; point < sweep.points(); ++point) {
    std::string damage;
    const std::optional<std::string> rows = read_point(sweep, output, point, &damage);
    if (!rows) throw std::runtime_error(damage.empty() ? point_file(output, point) + ": is gone" : damage);
    text += *rows;
  }
  const std::string file = output + "/sweep.csv";
  if (may_exist(file)) {
    const std::string old = read_file(file, kMostWrittenBytes);
    if (text.compare(0, old.size(), old) != 0)
      throw ConfigurationError(
          {"output: " + file +
           ": holds rows of another sweep or is damaged, and is never overwritten: must be another folder"});
  }
  write_table(output, "sweep", provenance(sweep.configuration(0)), std::move(text));
}

}  // namespace platoon
