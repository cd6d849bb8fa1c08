#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/spaced.hpp"

namespace platoon {

/// What varies in a sweep, a setting (see settings()) or a key of the model file (channel/delay), and its values.
struct SweepAxis {
  std::string name;
  std::vector<YAML::Node> list;
  std::optional<Spaced> spaced = {};  ///< in place of a list

  std::uint64_t size() const { return spaced ? spaced->count : list.size(); }
  YAML::Node at(std::uint64_t index) const;
};

/// A sweep file (see config/sweeps/headway.yaml): what all points share, what varies, and what is kept of each.
struct Sweep {
  YAML::Node shared;            ///< the document of the configuration that the axes change
  std::vector<SweepAxis> axes;  ///< the last varies fastest
  bool paired = false;          ///< value j of one axis goes with value j of every other; else each with each
  std::uint64_t shards = 1;     ///< of each point, where tasks of an array compute it
  bool all_followers = true;    ///< rows for each follower, not the last only
  bool all_steps = false;       ///< and for each step, not the last only

  static constexpr std::uint64_t kMostPoints = 100000;
  static constexpr std::uint64_t kMostRows = 10000000;

  std::uint64_t points() const;
  std::uint64_t tasks() const { return points() * shards; }

  /// The value of every axis at a point.
  std::vector<YAML::Node> values(std::uint64_t point) const;

  /// "headway = 2.4, loss = 0.1"
  std::string name_of(std::uint64_t point) const;

  /// The run of a point. Throws ConfigurationError.
  Configuration configuration(std::uint64_t point) const;
};

/// A value as one word without a comma: "2.4", "[1 -2 1]".
std::string word_of(const YAML::Node& value);

/// Reads a sweep file; `given` are settings that go before the file's, `model` the model where the file names none.
///
/// The number of points is counted before anything is made of them, and the configuration of every point is
/// checked. Throws ConfigurationError with all that is wrong.
Sweep read_sweep(const std::string& file, const std::map<std::string, std::string>& given, const std::string& model);

}  // namespace platoon
