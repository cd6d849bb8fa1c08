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

/// One axis of a sweep: a setting (see settings()) or a key of the model file (channel/delay), and its values.
struct SweepAxis {
  std::string name;
  std::vector<YAML::Node> list;
  std::optional<Spaced> spaced = {};  ///< instead of a list

  std::uint64_t size() const { return spaced ? spaced->count : list.size(); }
  YAML::Node at(std::uint64_t index) const;
};

/// A sweep file (see config/sweeps/headway.yaml): the configuration that all points share, the axes, and the rows to
/// keep.
struct Sweep {
  std::string folder;           ///< of the file; paths in it are relative to this
  YAML::Node shared;            ///< the document of the configuration that the axes change
  std::vector<SweepAxis> axes;  ///< the last varies fastest
  bool paired = false;          ///< value j of one axis goes with value j of every other; else all combinations
  std::uint64_t shards = 1;     ///< per point, if the tasks of an array compute it
  bool all_followers = true;    ///< rows for each follower, not only the last
  bool all_steps = false;       ///< rows for each step, not only the last

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

/// Reads a sweep file. The settings `given` take precedence over the file's.
///
/// Counts the points before creating any, and checks the configuration of every point. Throws ConfigurationError with
/// all problems.
Sweep read_sweep(const std::string& file, const std::map<std::string, std::string>& given);

}  // namespace platoon
