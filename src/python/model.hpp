#pragma once

#include <yaml-cpp/yaml.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon::python {

/// A model and its document in the format of a model file, checked.
class Model {
public:
  /// Throws ConfigurationError with all problems.
  explicit Model(YAML::Node document) : document_(std::move(document)), model_(parse_model(document_)) {}

  /// The model in a file, or the shipped one of this name. Throws std::system_error if there is no such file.
  static Model load(const std::string& file);
  /// The model of a text, YAML or JSON.
  static Model parse(const std::string& text);

  /// The model with other values: see override_value(). Values are JSON.
  Model replaced(const std::map<std::string, std::string>& changes) const;

  const PlatoonModel& model() const { return model_; }
  nlohmann::json document() const { return to_json(model_); }

  /// The model with the given settings of a run: see configuration_document(). Throws ConfigurationError.
  Configuration configuration(const std::map<std::string, std::string>& settings) const;

private:
  YAML::Node document_;
  PlatoonModel model_;
};

}  // namespace platoon::python
