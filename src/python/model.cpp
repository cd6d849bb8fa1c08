#include "python/model.hpp"

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/configuration/yaml_file.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"

namespace platoon::python {

namespace {

// A setting of a run is no part of a model.
void require_model_key(const std::string& name) {
  for (const Setting& setting : settings()) {
    if (name == setting.name && setting.model_key == nullptr)
      throw ConfigurationError({name + ": belongs to a run: must be a key of the model file"});
  }
}

}  // namespace

Model Model::load(const std::string& file) {
  const std::string found = shipped_file(file, "config");
  try {
    return Model(load_model(found));
  } catch (const ConfigurationError& error) {
    if (may_exist(found)) throw;
    throw std::system_error(ENOENT, std::generic_category(), error.what());
  }
}

Model Model::parse(const std::string& text) {
  const YAML::Node model = parse_yaml(text, "model");
  resolve_tables(model, std::filesystem::current_path().string());
  return Model(model);
}

Model Model::replaced(const std::map<std::string, std::string>& changes) const {
  YAML::Node document;
  document["model"] = YAML::Clone(document_);
  ProblemCollector problems;
  std::vector<std::pair<std::string, YAML::Node>> values;
  for (const auto& change : changes) {
    problems.check([&] {
      require_model_key(change.first);
      values.emplace_back(change.first, parse_yaml(change.second, change.first));
    });
  }
  // A section or list after the keys within it, which it would drop: such changes have no order of their own.
  std::vector<std::string> names;
  for (auto change = values.rbegin(); change != values.rend(); ++change)
    names.insert(change->second.IsScalar() ? names.begin() : names.end(), change->first);
  problems.check([&] { override_values(document, values); });
  problems.add(conflicts(names));
  problems.require_none();
  resolve_tables(document["model"], std::filesystem::current_path().string());
  return Model(document["model"]);
}

Configuration Model::configuration(const std::map<std::string, std::string>& settings) const {
  return parse_configuration(configuration_document(YAML::Node(YAML::NodeType::Map), settings), &model_);
}

}  // namespace platoon::python
