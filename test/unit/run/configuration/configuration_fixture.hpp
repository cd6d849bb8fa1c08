#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "unit/run/configuration/model_text.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {

using Settings = std::map<std::string, std::string>;

/// Configurations of the paper's example with some settings.
class ConfigurationTest : public testing::Test {
protected:
  Configuration configured(Settings settings) const {
    settings.emplace("model", model_);
    return parse_configuration(configuration_document(settings));
  }

  VehicleModel vehicle_with(const Settings& settings) const { return configured(settings).model.default_vehicle(); }

  Problems problems_with(const Settings& settings) const {
    return problems_of([&] { configured(settings); });
  }

  TemporaryFolder folder_;
  std::string model_ = folder_.file("model.yaml", kModelText);
};

}  // namespace platoon
