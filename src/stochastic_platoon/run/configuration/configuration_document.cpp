#include "stochastic_platoon/run/configuration/configuration_document.hpp"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <iterator>
#include <set>
#include <vector>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"
#include "stochastic_platoon/run/configuration/yaml_value.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"

namespace platoon {

namespace {

void require_known(const std::map<std::string, std::string>& given) {
  std::set<std::string> known{"model"};
  for (const Setting& setting : settings()) known.insert(setting.name);
  const std::string allowed = boost::algorithm::join(known, ", ");
  ProblemCollector problems;
  std::vector<std::string> names;
  for (const auto& [name, value] : given) {
    if (known.count(name) == 0) problems.add(name + ": unknown setting: allowed are " + allowed);
    if (!value.empty()) names.push_back(name);
  }
  problems.add(conflicts(names));
  problems.require_none();
}

// The index in a list that a part of a path is; the list's size if it is none.
std::size_t index_in(const YAML::Node& list, const std::string& key) {
  const bool is_number = !key.empty() && key.size() < 9 && key.find_first_not_of("0123456789") == std::string::npos;
  return is_number ? std::min<std::size_t>(std::stoul(key), list.size()) : list.size();
}

// Sets the value at the path "a/b" and creates missing mappings. Returns false if the path leads through a value that
// is neither a mapping nor a list of that length.
bool put_at(const std::string& path, const YAML::Node& value, YAML::Node node) {
  const std::size_t slash = path.find('/');
  const std::string key = path.substr(0, slash);
  const bool leaf = slash == std::string::npos;
  if (node.IsSequence()) {
    const std::size_t index = index_in(node, key);
    if (index == node.size()) return false;
    if (!leaf) return put_at(path.substr(slash + 1), value, node[index]);
    node[index] = YAML::Clone(value);
    return true;
  }
  if (!node.IsMap() && !node.IsNull()) return false;
  if (leaf) {
    node[key] = YAML::Clone(value);
    return true;
  }
  if (!node[key]) node[key] = YAML::Node(YAML::NodeType::Map);
  return put_at(path.substr(slash + 1), value, node[key]);
}

// A loop over a mapping as over a list, or the reverse, yields invalid nodes. They are false, and their IsMap() throws.
bool has_key(const YAML::Node& node, const std::string& key) {
  return node && node.IsMap() && node[key];
}

// The value at a key; null unless the node is a mapping that has it.
YAML::Node value_at(const YAML::Node& node, const char* key) {
  return has_key(node, key) ? node[key] : YAML::Node();
}

std::string text_at(const YAML::Node& node, const char* key) {
  const YAML::Node value = value_at(node, key);
  return value.IsScalar() ? value.Scalar() : "";
}

// The path of a link's key in a model that lists its inputs: losses belong to the input of varied_losses(), all other
// keys to the first position, for which the vehicle may give them.
std::string path_of_link(const std::string& key, const YAML::Node& model) {
  const std::string first = key.substr(0, key.find('/'));
  const YAML::Node inputs = value_at(model, "inputs");
  if ((first != "noise_variance" && first != "channel") || !inputs.IsSequence() || inputs.size() == 0) return key;
  std::string of_position = key;
  std::vector<LossPlace> places;
  std::vector<std::string> paths;
  bool at_vehicle = true;
  for (const YAML::Node& input : inputs) {
    const bool is_position = text_at(input, "signal") == "position";
    const YAML::Node given = is_position && at_vehicle && !has_key(input, "channel") ? model : input;
    const std::string own = "inputs/" + std::to_string(paths.size()) + "/" + key;
    paths.push_back(given.is(model) ? key : own);
    const YAML::Node channel = value_at(given, "channel");
    places.push_back({is_position, has_key(channel, "loss"), text_at(channel, "packet")});
    if (is_position && at_vehicle && has_key(input, first)) of_position = own;
    at_vehicle = at_vehicle && !is_position;
  }
  return key.find("/loss") != std::string::npos ? paths[varied_losses(places)] : of_position;
}

// Removes the key at the path "a/b", if there is one.
void remove_at(const std::string& path, YAML::Node node) {
  const std::size_t slash = path.find('/');
  const std::string key = path.substr(0, slash);
  if (slash == std::string::npos) {
    if (node.IsMap()) node.remove(key);
  } else if (node.IsSequence() && index_in(node, key) < node.size()) {
    remove_at(path.substr(slash + 1), node[index_in(node, key)]);
  } else if (has_key(node, key)) {
    remove_at(path.substr(slash + 1), node[key]);
  }
}

bool put_model_key(const Setting& setting, const YAML::Node& value, const YAML::Node& model) {
  for (const char* key : setting.replaces) remove_at(path_of_link(key, model), model);
  return put_at(path_of_link(setting.model_key, model), value, model);
}

void put(const Setting& setting, const std::string& value, YAML::Node& document) {
  if (setting.model_key == nullptr) {
    document["run"][setting.name] = value;
  } else if (!value.empty() && document["model"].IsMap()) {
    // A model that is not a mapping takes no override: read_model() reports it.
    put_model_key(setting, YAML::Node(value), document["model"]);
  }
}

void resolve_traces(const std::string& folder, const YAML::Node& vehicle) {
  const auto of_link = [&](const YAML::Node& input) {
    YAML::Node file = value_at(value_at(value_at(input, "channel"), "loss"), "trace");
    if (file.IsScalar()) file = (std::filesystem::path(folder) / file.Scalar()).string();
  };
  of_link(vehicle);
  for (const YAML::Node& input : value_at(vehicle, "inputs")) of_link(input);
}

// Throws for a key of a vehicle type that the model does not have: no vehicle would be of the type that it makes.
void require_type(const YAML::Node& model, const std::string& name) {
  const std::string section = "vehicle_types/";
  const std::size_t end = name.find('/', section.size());
  if (name.rfind(section, 0) != 0 || end == std::string::npos) return;
  const YAML::Node types = value_at(model, "vehicle_types");
  if (has_key(types, name.substr(section.size(), end - section.size()))) return;
  std::set<std::string> names;
  for (const auto& type : types) names.insert(type.first.Scalar());
  throw ConfigurationError({name + ": must be a key of one of the vehicle types: " +
                            (names.empty() ? "the model has none" : boost::algorithm::join(names, ", "))});
}

// The document of a model and the given settings, with the defaults of the others.
YAML::Node document_of(const YAML::Node& model, const std::map<std::string, std::string>& given) {
  YAML::Node document;
  document["version"] = kVersion;
  document["model"] = model;
  for (const Setting& setting : settings()) {
    const auto value = given.find(setting.name);
    put(setting, value == given.end() ? setting.default_value : value->second, document);
  }
  return document;
}

// The faults of the settings where no model can be read: those of the run, and of the values for keys of the model. An
// empty model also lacks all other keys.
std::vector<std::string> faults_without_model(const std::map<std::string, std::string>& given) {
  const YAML::Node document = document_of(YAML::Node(YAML::NodeType::Map), given);
  std::vector<std::string> problems, of_model;
  read_run_options(Section(document["run"], "run", problems));
  read_model(Section(document["model"], "model", of_model));
  for (const Setting& setting : settings()) {
    const auto value = given.find(setting.name);
    if (setting.model_key == nullptr || value == given.end() || value->second.empty()) continue;
    const std::string begin =
        std::string("model/") + setting.model_key + ": " + shown(YAML::Node(value->second)) + ": ";
    std::copy_if(of_model.begin(), of_model.end(), std::back_inserter(problems),
                 [&](const std::string& problem) { return problem.rfind(begin, 0) == 0; });
  }
  return problems;
}

}  // namespace

YAML::Node load_model(const std::string& file) {
  if (!may_exist(file)) {
    throw ConfigurationError({"model: " + (file.empty() ? "(empty)" : file) +
                              ": no such file: must be a model file, or one of the shipped " +
                              shipped_names("config")});
  }
  YAML::Node model = load_yaml(file);
  if (model.IsNull()) throw ConfigurationError({"model: " + file + ": is empty: must be a mapping of keys"});
  resolve_tables(model, std::filesystem::absolute(file).parent_path().string());
  return model;
}

void resolve_tables(const YAML::Node& model, const std::string& folder) {
  YAML::Node drive = value_at(value_at(model, "leader"), "file");
  if (drive.IsScalar()) drive = shipped_file(drive.Scalar(), "config/leaders", folder);
  resolve_traces(folder, model);
  for (const auto& type : value_at(model, "vehicle_types")) resolve_traces(folder, type.second);
}

YAML::Node configuration_document(const std::map<std::string, std::string>& given) {
  ProblemCollector problems;
  problems.check([&] { require_known(given); });
  const auto model =
      problems.result_of([&] { return load_model(given.count("model") > 0 ? given.at("model") : paper_model_file()); });
  if (!model) {
    problems.add(faults_without_model(given));
  } else if (!problems.all().empty()) {
    problems.check([&] { parse_configuration(document_of(*model, given)); });
  }
  problems.require_none();
  return document_of(*model, given);
}

YAML::Node configuration_document(const YAML::Node& model, const std::map<std::string, std::string>& given) {
  require_known(given);
  return document_of(YAML::Clone(model), given);
}

YAML::Node configuration_document(const Configuration& base, const std::map<std::string, std::string>& given) {
  require_known(given);
  YAML::Node document = YAML::Load(to_json(base).dump());
  document["version"] = kVersion;
  if (given.count("model") > 0 && !given.at("model").empty()) document["model"] = load_model(given.at("model"));
  for (const Setting& setting : settings()) {
    const auto value = given.find(setting.name);
    if (value != given.end()) put(setting, value->second, document);
  }
  return document;
}

void override_value(YAML::Node& document, const std::string& name, const YAML::Node& value) {
  for (const Setting& setting : settings()) {
    if (name != setting.name && (setting.model_key == nullptr || name != setting.model_key)) continue;
    // A mapping is the section of this name.
    if (value.IsMap() && std::count(setting.replaces.begin(), setting.replaces.end(), name) > 0) break;
    if (setting.model_key == nullptr) {
      document["run"][name] = YAML::Clone(value);
      return;
    }
    if (put_model_key(setting, value, document["model"])) return;
    throw ConfigurationError({name + ": leads through a value of the model file that is not a mapping"});
  }
  require_type(document["model"], name);
  if (put_at(name, value, document["model"])) return;
  throw ConfigurationError({name + ": must be a setting, or lead to a key of the model file"});
}

void override_values(YAML::Node& document, const std::vector<std::pair<std::string, YAML::Node>>& values) {
  ProblemCollector problems;
  for (const bool single : {false, true}) {
    for (const auto& change : values) {
      if (change.second.IsScalar() == single)
        problems.check([&] { override_value(document, change.first, change.second); });
    }
  }
  problems.require_none();
}

}  // namespace platoon
