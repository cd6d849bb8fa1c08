#include "stochastic_platoon/run/scaling/sweep_file.hpp"

#include <algorithm>
#include <filesystem>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/statistics/shard.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {

const std::vector<std::string> kVarying = {"headway",     "headway_seconds", "noise_variance", "loss",  "mean_burst",
                                           "delay",       "leader",          "followers",      "steps", "seed",
                                           "realizations"};

bool is_among(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// The fewest digits that restore the value's bits.
std::string text_of(double value) {
  const std::string text = formatted("%.15g", value);
  return std::stod(text) == value ? text : formatted("%.17g", value);
}

bool is_setting(const std::string& name) {
  const std::vector<Setting>& all = settings();
  return std::any_of(all.begin(), all.end(), [&](const Setting& setting) { return name == setting.name; });
}

std::vector<SweepAxis> read_axes(const YAML::Node& node, Section section) {
  std::vector<SweepAxis> axes;
  const std::vector<std::string> names = section.keys();
  for (const std::string& name : names) {
    const YAML::Node value = node[name];
    if (name.find_first_of(",\"\n") != std::string::npos || (is_setting(name) && !is_among(kVarying, name))) {
      std::string allowed;
      for (const std::string& setting : kVarying) allowed += setting + ", ";
      section.reject(name, "given", allowed + "or a key of the model file, as channel/delay");
      continue;
    }
    SweepAxis axis{name, {}};
    if (value.IsScalar()) axis.spaced = parse_spaced(value.Scalar());
    for (std::size_t i = 0; value.IsSequence() && i < value.size(); ++i) axis.list.push_back(value[i]);
    if (axis.size() == 0) {
      section.reject(name, value.IsScalar() ? printable(shortened(value.Scalar())) : "no value",
                     "a list of values, or FROM:TO:COUNT with FROM <= TO and COUNT from 1");
    }
    axes.push_back(axis);
  }
  section.reject_unknown_keys();
  for (const std::string& problem : conflicts(names)) section.report(problem);
  if (axes.empty() && section.is_mapping()) section.report_whole("no axis: must name at least one varying parameter");
  return axes;
}

// Counts the points before any is created. Returns whether they can be.
bool check_size(const Sweep& sweep, std::vector<std::string>& problems) {
  const auto is_empty = [](const SweepAxis& axis) { return axis.size() == 0; };
  if (sweep.axes.empty() || std::any_of(sweep.axes.begin(), sweep.axes.end(), is_empty)) return false;
  std::string product;
  double points = 1.0;
  for (const SweepAxis& axis : sweep.axes) {
    product += (product.empty() ? "" : " x ") + std::to_string(axis.size());
    points *= static_cast<double>(axis.size());
    if (sweep.paired && axis.size() != sweep.axes.front().size()) {
      problems.push_back("combine: paired: " + axis.name + " has " + std::to_string(axis.size()) + " values and " +
                         sweep.axes.front().name + " " + std::to_string(sweep.axes.front().size()) +
                         ": must have as many");
      return false;
    }
  }
  if (sweep.paired) points = static_cast<double>(sweep.axes.front().size());
  if (points <= static_cast<double>(Sweep::kMostPoints)) return true;
  problems.push_back("vary: " + (sweep.paired ? "" : product + " = ") + formatted("%.10g points", points) +
                     ": must be at most " + std::to_string(Sweep::kMostPoints));
  return false;
}

// Checks every point's configuration; reports each problem once.
void check_points(const Sweep& sweep, std::vector<std::string>& problems) {
  std::map<std::string, std::uint64_t> seen;
  std::vector<std::pair<std::string, std::uint64_t>> first;
  double rows = 0.0;
  for (std::uint64_t point = 0; point < sweep.points(); ++point) {
    try {
      const RunOptions run = sweep.configuration(point).run;
      rows += static_cast<double>(sweep.all_followers ? run.followers : 1) *
              static_cast<double>(sweep.all_steps ? run.steps : 1);
    } catch (const ConfigurationError& error) {
      for (const std::string& problem : error.problems()) {
        if (++seen[problem] == 1) first.emplace_back(problem, point);
      }
    }
  }
  std::vector<std::string> of_points;
  for (const auto& [problem, point] : first) {
    const std::uint64_t others = seen[problem] - 1;
    of_points.push_back("point " + std::to_string(point) + " (" + sweep.name_of(point) + ")" +
                        (others > 0 ? " and " + std::to_string(others) + " more" : "") + ": " + problem);
  }
  of_points = abbreviated(of_points);
  problems.insert(problems.end(), of_points.begin(), of_points.end());
  if (rows > static_cast<double>(Sweep::kMostRows)) {
    problems.push_back(formatted("keep: %.10g rows: must be at most ", rows) + std::to_string(Sweep::kMostRows) +
                       " (keep fewer followers or steps)");
  }
}

}  // namespace

YAML::Node SweepAxis::at(std::uint64_t index) const {
  return spaced ? YAML::Node(text_of(spaced->at(index))) : list.at(index);
}

std::uint64_t Sweep::points() const {
  if (paired) return axes.front().size();
  std::uint64_t product = 1;
  for (const SweepAxis& axis : axes) product *= axis.size();
  return product;
}

std::vector<YAML::Node> Sweep::values(std::uint64_t point) const {
  std::vector<YAML::Node> found(axes.size());
  for (std::size_t i = axes.size(); i-- > 0;) {
    found[i] = axes[i].at(paired ? point : point % axes[i].size());
    if (!paired) point /= axes[i].size();
  }
  return found;
}

std::string Sweep::name_of(std::uint64_t point) const {
  const std::vector<YAML::Node> found = values(point);
  std::string text;
  for (std::size_t i = 0; i < axes.size(); ++i)
    text += (i == 0 ? "" : ", ") + axes[i].name + " = " + shortened(word_of(found[i]));
  return text;
}

Configuration Sweep::configuration(std::uint64_t point) const {
  YAML::Node document = YAML::Clone(shared);
  const std::vector<YAML::Node> found = values(point);
  std::vector<std::pair<std::string, YAML::Node>> varied;
  for (std::size_t i = 0; i < axes.size(); ++i) varied.emplace_back(axes[i].name, found[i]);
  override_values(document, varied);
  resolve_tables(document["model"], folder);
  Configuration configuration = parse_configuration(document);
  if (configuration.run.averaging() == Averaging::over_time)
    throw ConfigurationError({"steps: 0: must be at least 1 for a Monte Carlo"});
  if (shards > configuration.run.realizations) {
    throw ConfigurationError({"shards: " + std::to_string(shards) + ": must be at most the " +
                              std::to_string(configuration.run.realizations) + " realizations"});
  }
  configuration.run.hosting = Hosting::monte_carlo;
  return configuration;
}

std::string word_of(const YAML::Node& value) {
  if (value.IsScalar()) {
    std::string text = printable(value.Scalar());
    std::replace(text.begin(), text.end(), ',', ' ');
    return text;
  }
  YAML::Emitter emitter;
  emitter << YAML::Flow << value;
  std::string text;
  for (const char c : std::string(emitter.c_str())) {
    if (c != ',' && c != '\n') text += c;
  }
  return printable(text);
}

Sweep read_sweep(const std::string& file, const std::map<std::string, std::string>& given) {
  const YAML::Node node = load_yaml(file, "sweep");
  std::vector<std::string> problems;
  Section document(node, "", problems);
  Sweep sweep;
  sweep.folder = std::filesystem::absolute(file).parent_path().string();
  std::map<std::string, std::string> shared;
  if (document.has("model")) shared["model"] = shipped_file(document.text("model"), "config", sweep.folder);
  const bool names_model = problems.empty();
  std::vector<std::string> names = kVarying, no_texts;
  names.insert(names.end(), {"batch", "signals"});
  for (const std::string& name : names) {
    if (!document.has(name)) continue;
    if (node[name].IsScalar()) {
      shared[name] = document.text(name);
    } else if (given.count(name) == 0) {
      no_texts.push_back(name);
    }
  }
  for (const auto& entry : given) shared[entry.first] = entry.second;
  add_monte_carlo_batch(shared);
  const bool varies = document.has("vary") && node["vary"].IsMap();
  Section vary = document.section("vary");
  if (varies) sweep.axes = read_axes(node["vary"], vary);
  sweep.paired = document.has("combine") && document.choice("combine", {"grid", "paired"}) == "paired";
  if (document.has("shards")) sweep.shards = static_cast<std::uint64_t>(document.integer("shards", 1, kMostShards));
  if (document.has("keep")) {
    const std::size_t before = problems.size();
    Section keep = document.section("keep");
    sweep.all_followers = !keep.has("followers") || keep.choice("followers", {"all", "last"}) == "all";
    sweep.all_steps = keep.has("steps") && keep.choice("steps", {"all", "last"}) == "all";
    keep.reject_unknown_keys();
    if (problems.size() > before) sweep.all_followers = sweep.all_steps = false;  // no limit of rows
  }
  document.reject_unknown_keys();
  const bool countable = check_size(sweep, problems);
  ProblemCollector of_runs;
  of_runs.check([&] {
    if (!names_model) return;
    sweep.shared = configuration_document(shared);
    for (const std::string& name : no_texts) override_value(sweep.shared, name, node[name]);
    if (countable) check_points(sweep, problems);
  });
  problems.insert(problems.end(), of_runs.all().begin(), of_runs.all().end());
  if (!problems.empty()) throw ConfigurationError(problems);
  return sweep;
}

}  // namespace platoon
