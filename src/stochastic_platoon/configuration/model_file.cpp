#include "stochastic_platoon/configuration/model_file.hpp"

#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <utility>

#include "stochastic_platoon/configuration/configuration_error.hpp"

namespace platoon {

namespace {

// The stamps of ROS count nanoseconds, and end after 136 years.
const Allowed kSamplePeriod{"a finite number >= 1e-9", std::numeric_limits<double>::quiet_NaN(), 1e-9, 1e6};

TransferFunction read_fraction(Section& section, std::vector<std::string>& problems,
                               const std::string& name) {
  const Eigen::VectorXd numerator = section.numbers("numerator", kLongestRow);
  const Eigen::VectorXd denominator = section.numbers("denominator", kLongestRow);
  section.reject_unknown_keys();
  try {
    if (denominator.cwiseAbs().maxCoeff() > 0.0) return {numerator, denominator};
    section.reject("denominator", "all zero", "a polynomial other than 0");
  } catch (const std::invalid_argument& error) {
    problems.push_back(name + "/" + error.what());
  }
  return {numerator, Eigen::VectorXd::Ones(1)};
}

std::optional<ClosedLoop> read_given_loop(Section section, std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  const Eigen::MatrixXd a = section.matrix("A");
  const Eigen::VectorXd b = section.numbers("B", kLongestRow);
  const Eigen::VectorXd c = section.numbers("C", kLongestRow);
  section.reject_unknown_keys();
  if (problems.size() > before) return std::nullopt;
  try {
    return closed_loop_from(StateSpace(a, b, c.transpose()));
  } catch (const std::invalid_argument& error) {
    problems.push_back(std::string("closed_loop/") + error.what());
    return std::nullopt;
  }
}

// What drives vehicle 0: the virtual leader's speeds, or vehicle 0's own positions as recorded.
struct LeaderContent {
  LeaderProfile profile{{}, 1.0};
  std::vector<double> recorded;  ///< y_0(-1), y_0(0), ... [m]
};

LeaderProfile read_profile(Section& section, double sample_period, std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  std::vector<SpeedChange> changes;
  for (Section& entry : section.sections("speed")) {
    const std::int64_t step = entry.integer("from_step", 0, std::int64_t{1} << 46);
    changes.push_back({step, entry.number("value", kAnyFinite)});
    entry.reject_unknown_keys();
  }
  if (problems.size() > before) return LeaderProfile({}, 1.0);
  try {
    return LeaderProfile(changes, sample_period);
  } catch (const std::invalid_argument& error) {
    problems.push_back(std::string("leader/speed: ") + error.what());
    return LeaderProfile({}, 1.0);
  }
}

LeaderContent read_leader(Section section, double sample_period, std::vector<std::string>& problems) {
  LeaderContent leader;
  if (section.has("positions")) {
    const Eigen::VectorXd positions = section.numbers("positions");
    leader.recorded.assign(positions.data(), positions.data() + positions.size());
    if (section.has("speed")) section.reject("speed", "given", "absent beside positions");
  } else {
    leader.profile = read_profile(section, sample_period, problems);
  }
  section.reject_unknown_keys();
  return leader;
}

InitialPosition read_initial_position(Section section) {
  InitialPosition position;
  position.mean = section.number("mean", kAnyFinite);
  position.variance = section.number("variance", kNotNegative);
  section.reject_unknown_keys();
  return position;
}

// The closed loop and, where it was not given itself, what it is formed from.
struct Loop {
  ClosedLoop closed;
  std::optional<LoopDesign> design;
};

std::optional<Loop> read_designed_loop(Section& document, double headway,
                                       std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  Section plant_section = document.section("plant");
  const TransferFunction plant = read_fraction(plant_section, problems, "plant");
  Section controller_section = document.section("controller");
  const bool divide = controller_section.has("divide_by_one_plus_headway") &&
                      controller_section.boolean("divide_by_one_plus_headway");
  const LoopDesign design{plant, read_fraction(controller_section, problems, "controller"), divide};
  if (problems.size() > before) return std::nullopt;
  try {
    return Loop{close_loop(design, headway), design};
  } catch (const std::invalid_argument& error) {
    problems.push_back(std::string("plant, controller: ") + error.what());
    return std::nullopt;
  }
}

std::optional<Loop> read_loop(Section& document, double headway, std::vector<std::string>& problems) {
  if (!document.has("closed_loop")) return read_designed_loop(document, headway, problems);
  for (const char* key : {"plant", "controller"}) {
    if (document.has(key))
      document.reject(key, "given", "absent beside closed_loop, which stands in its place");
  }
  const std::optional<ClosedLoop> given = read_given_loop(document.section("closed_loop"), problems);
  return given ? std::optional<Loop>(Loop{*given, std::nullopt}) : std::nullopt;
}

nlohmann::json to_list(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

nlohmann::json to_json(const Eigen::MatrixXd& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) rows.push_back(to_list(matrix.row(i)));
  return rows;
}

nlohmann::json to_json(const TransferFunction& fraction) {
  return {{"numerator", to_list(fraction.numerator())}, {"denominator", to_list(fraction.denominator())}};
}

}  // namespace

nlohmann::json to_json(const StateSpace& loop) {
  return {{"A", to_json(loop.a())}, {"B", to_list(loop.b())}, {"C", to_list(loop.c())}};
}

std::optional<PlatoonModel> read_model(Section document, std::vector<std::string>& problems) {
  if (!document.is_mapping()) return std::nullopt;
  const std::size_t before = problems.size();
  const double headway = document.number("time_headway", kPositive);
  const double standstill_distance = document.number("standstill_distance", kNotNegative);
  const double sample_period = document.number("sample_period", kSamplePeriod);
  const double noise_variance = document.number("noise_variance", kNotNegative);
  const bool allow_unstable = document.has("allow_unstable") && document.boolean("allow_unstable");
  const LeaderContent leader = read_leader(document.section("leader"), sample_period, problems);
  const InitialPosition initial = read_initial_position(document.section("initial_position"));
  const std::optional<Loop> loop = read_loop(document, headway, problems);
  document.reject_unknown_keys();
  if (problems.size() == before) {
    for (const std::string& problem : violated_assumptions(loop->closed, headway, allow_unstable))
      problems.push_back(problem);
  }
  if (problems.size() > before) return std::nullopt;
  return PlatoonModel{loop->closed,   headway, standstill_distance, sample_period, noise_variance,
                      leader.profile, initial, allow_unstable,      loop->design,  leader.recorded};
}

PlatoonModel parse_model(const YAML::Node& node) {
  std::vector<std::string> problems;
  const std::optional<PlatoonModel> model = read_model(Section(node, "", problems), problems);
  if (!problems.empty()) throw ConfigurationError(problems);
  return *model;
}

namespace {

// By the lines that separate them: yaml-cpp's own LoadAll does not come to an end on some files.
bool holds_several_documents(const std::string& file) {
  std::ifstream stream(file);
  bool begun = false;
  for (std::string line; std::getline(stream, line);) {
    const bool separates =
        line.compare(0, 3, "---") == 0 && (line.size() == 3 || line[3] == ' ' || line[3] == '\r');
    if (separates && begun) return true;
    const std::size_t content = line.find_first_not_of(" \t\r");
    begun =
        begun || separates || (content != std::string::npos && line[content] != '#' && line[content] != '%');
  }
  return false;
}

}  // namespace

YAML::Node load_yaml(const std::string& file) {
  if (std::filesystem::is_directory(file))
    throw ConfigurationError({"model: " + file + ": must be a file, not a folder"});
  try {
    const YAML::Node document = YAML::LoadFile(file);
    if (holds_several_documents(file))
      throw ConfigurationError({"model: " + file + ": several documents: must be one"});
    return document;
  } catch (const YAML::BadFile&) {
    throw ConfigurationError({"model: " + file + ": must be a file that can be read"});
  } catch (const YAML::Exception& error) {
    throw ConfigurationError({"model: " + file + ": must be YAML: " + error.what()});
  } catch (const std::ios_base::failure&) {
    throw ConfigurationError({"model: " + file + ": must be a file that can be read"});
  }
}

nlohmann::json to_json(const PlatoonModel& model) {
  nlohmann::json speed = nlohmann::json::array();
  for (const SpeedChange& change : model.leader.changes()) {
    speed.push_back({{"from_step", change.from_step}, {"value", change.value}});
  }
  nlohmann::json document = {
      {"time_headway", model.headway},
      {"standstill_distance", model.standstill_distance},
      {"sample_period", model.sample_period},
      {"noise_variance", model.noise_variance},
      {"leader", model.recorded_leader.empty() ? nlohmann::json{{"speed", speed}}
                                               : nlohmann::json{{"positions", model.recorded_leader}}},
      {"initial_position",
       {{"mean", model.initial_position.mean}, {"variance", model.initial_position.variance}}},
      {"allow_unstable", model.allow_unstable}};
  if (model.design) {
    document["plant"] = to_json(model.design->plant);
    document["controller"] = to_json(model.design->controller);
    document["controller"]["divide_by_one_plus_headway"] = model.design->divide_by_one_plus_headway;
  } else {
    document["closed_loop"] = to_json(model.loop.realization);
  }
  return document;
}

}  // namespace platoon
