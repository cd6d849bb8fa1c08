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

/// Callbacks in the order of the recording; topics with an empty callback are skipped.
struct BagContent {
  std::function<void(const PlatoonTopic&, const std::string& json)> configuration;
  using OfStream = std::function<void(const PlatoonTopic&, const stochastic_platoon::Position::ConstPtr&)>;
  OfStream position, predecessor_position, input, predecessor_input;
  std::function<void(const PlatoonTopic&, const stochastic_platoon::ErrorStatistics::ConstPtr&)> error_statistics;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< in bytes
};

/// Topics of a recording that were skipped, and why reading ended early.
struct BagRemainder {
  std::set<std::string> foreign_topics;  ///< of other names or types
  std::string ending;                    ///< why and where reading ended, if a cut or damaged file was accepted
};

/// Reads a recording; several files are read as one. Each message is verified by its checksum before its callback is
/// called. Throws BagError if a file is missing, is not a bag, or is in a state that `source` does not accept.
BagRemainder read_bags(const BagSource& source, const BagContent& content);

/// Reads the configuration of a file, its last `chunks` whole chunks and everything after them, up to the end of the
/// file or the first damage. Earlier chunks are skipped, so that a file of gigabytes takes little longer. Returns true
/// if no chunk was skipped. Throws BagError if the file is not a bag.
bool read_end_of_bag(const std::string& file, std::size_t chunks, const BagContent& content);

}  // namespace platoon
