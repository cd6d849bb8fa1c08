#pragma once

#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <string>

#include "stochastic_platoon/ros/bags/bag_source.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon {

/// Callbacks in the order of the recording; topics with an empty callback are passed over.
struct BagContent {
  std::function<void(const PlatoonTopic&, const std::string& json)> configuration;
  std::function<void(const PlatoonTopic&, const stochastic_platoon::Position::ConstPtr&)> position;
  std::function<void(const PlatoonTopic&, const stochastic_platoon::Position::ConstPtr&)> predecessor_position;
  std::function<void(const PlatoonTopic&, const stochastic_platoon::ErrorStatistics::ConstPtr&)> error_statistics;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< in bytes
};

/// What a recording holds besides, and how it ends.
struct BagRemainder {
  std::set<std::string> foreign_topics;  ///< of other names or types: passed over
  std::string ending;                    ///< of files that are accepted cut or damaged: why and where reading ended
};

/// Reads a recording, several files as one. Every message is verified by its checksum before it comes to a callback.
/// Throws BagError for a file that is missing, foreign, or not as `source` accepts it.
BagRemainder read_bags(const BagSource& source, const BagContent& content);

/// Reads the configuration of a file and what is in its last chunks, so many of the whole ones and what is behind them,
/// up to its end or the first damage. What is before is passed over, so that it takes little longer for a file of
/// gigabytes. Returns whether nothing was passed over. Throws BagError when it is no bag at all.
bool read_end_of_bag(const std::string& file, std::size_t chunks, const BagContent& content);

}  // namespace platoon
