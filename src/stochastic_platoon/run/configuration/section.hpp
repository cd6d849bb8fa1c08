#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Dense>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace platoon {

constexpr double kLargest = 1e100;
constexpr Eigen::Index kUnlimited = -1;
constexpr Eigen::Index kLongestRow = 100;  ///< far beyond the order that a closed loop may have

/// What a number may be. Bounds of NaN do not bind. Beyond 1e100 what is computed of a number, its square, sums
/// over a run, would overflow.
struct Allowed {
  std::string text;                                         ///< the end of the sentence "must be ..."
  double above;                                             ///< exclusive lower bound
  double at_least;                                          ///< inclusive lower bound
  double most = kLargest;                                   ///< of the magnitude
  double below = std::numeric_limits<double>::quiet_NaN();  ///< exclusive upper bound
};

extern const Allowed kAnyFinite, kPositive, kNotNegative, kLossProbability;

/// Reads one mapping of a YAML document key by key and collects what is wrong with it, so that all errors are
/// reported at once.
///
/// A reader returns the value, or a harmless stand-in after it has put an error in `problems`: check
/// `problems` before the values are used. Numbers may stand in quotes: the parameter server and the command
/// line hand on strings.
class Section {
public:
  /// `path` names the section in messages, empty for the document itself.
  Section(const YAML::Node& node, const std::string& path, std::vector<std::string>& problems);

  /// False for what is missing or no mapping, which is reported already.
  bool is_mapping() const { return node_.IsMap(); }

  /// Whether an optional key is given.
  bool has(const std::string& key);

  double number(const std::string& key, const Allowed& allowed);
  std::int64_t integer(const std::string& key, std::int64_t least, std::int64_t most);
  bool boolean(const std::string& key);
  std::string text(const std::string& key);
  std::string choice(const std::string& key, const std::vector<std::string>& choices);
  /// A list of finite numbers, not empty, `longest` at most.
  Eigen::VectorXd numbers(const std::string& key, Eigen::Index longest = kUnlimited);
  /// A list of rows of finite numbers, all of one length, not empty, at most kLongestRow of each.
  Eigen::MatrixXd matrix(const std::string& key);
  /// A list of names, not empty.
  std::vector<std::string> texts(const std::string& key);
  Section section(const std::string& key);
  /// A list of mappings, which may be empty.
  std::vector<Section> sections(const std::string& key);

  /// The keys of this mapping, whatever they are: all of them count as known.
  std::vector<std::string> keys();

  /// Whether the value at an optional key is a list.
  bool is_list(const std::string& key);

  /// Another problem, whose text begins with the key.
  void report(const std::string& problem) { problems_.push_back(name(problem)); }

  /// How many errors there are so far, of the whole document.
  std::size_t problems() const { return problems_.size(); }

  /// What names a key of this section in messages.
  std::string name(const std::string& key) const { return path_.empty() ? key : path_ + "/" + key; }

  /// Reports the keys that nobody asked for, or that stand twice. Call it last.
  void reject_unknown_keys();

  /// Reports that the value at `key` is not what it must be.
  void reject(const std::string& key, const std::string& value, const std::string& allowed);

private:
  YAML::Node require(const std::string& key, const std::string& allowed);

  YAML::Node node_;
  std::string path_;
  std::vector<std::string>& problems_;
  std::set<std::string> known_;
};

}  // namespace platoon
