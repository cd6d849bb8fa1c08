#pragma once

#include <rosbag/bag.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <functional>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/messages/topics.hpp"

namespace platoon {

/// A bag that cannot be read, or not without asking for its readable part; names the file and the reason.
class BagError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A closed bag. Throws BagError.
std::unique_ptr<rosbag::Bag> open_bag(const std::string& file);

/// File names from a text that separates them by spaces.
std::vector<std::string> bag_files(const std::string& text);

/// Callbacks in the order of the recorded times; topics with an empty callback are skipped.
struct BagContent {
  std::function<void(const PlatoonTopic&, const std::string& json)> configuration;
  std::function<void(const PlatoonTopic&, const stochastic_platoon::Position::ConstPtr&)> position;
  std::function<void(const PlatoonTopic&, const stochastic_platoon::Position::ConstPtr&)>
      predecessor_position;
  std::function<void(const PlatoonTopic&, const stochastic_platoon::ErrorStatistics::ConstPtr&)>
      error_statistics;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< in messages, of an intact bag
};

/// What a bag holds besides, and what was wrong with it.
struct BagRemainder {
  std::set<std::string> foreign_topics;  ///< of other names or types: passed over
  std::string damage;                    ///< of a damaged bag: what is wrong and where reading ended
};

/// Reads closed bags, several together as one. Throws BagError for a missing, damaged, unfinished or foreign
/// file.
BagRemainder read_bags(const std::vector<std::string>& files, const BagContent& content);

/// Reads what there is of a truncated bag, or of the .active file of a recorder that was killed: records from
/// the start of the file to the first that is cut off or makes no sense, in the order of the file. Throws
/// BagError when it is no bag at all.
BagRemainder read_damaged_bag(const std::string& file, const BagContent& content);

/// Reads of such a file its configuration and what is in its last chunks, so many of the whole ones and what is behind
/// them. What is before is passed over, so that it takes little longer for a file of gigabytes. Returns whether nothing
/// was passed over. Throws BagError as read_damaged_bag() does.
bool read_end_of_bag(const std::string& file, std::size_t chunks, const BagContent& content);

}  // namespace platoon
