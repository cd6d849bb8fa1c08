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
constexpr Eigen::Index kLongestRow = 100;  ///< far beyond the order of any closed loop

/// The allowed numbers: at least `least`, below `below`, and of a magnitude of at most `most`. Beyond 1e100 the square
/// of a number and sums over a run would overflow.
struct Allowed {
  std::string text;  ///< end of the sentence "must be ..."
  double least = -std::numeric_limits<double>::infinity();
  double most = kLargest;
  double below = std::numeric_limits<double>::infinity();
};
constexpr double kAboveZero = std::numeric_limits<double>::denorm_min();  ///< the smallest number above 0

extern const Allowed kAnyFinite, kPositive, kNotNegative, kLossProbability;

/// Reads one mapping of a YAML document key by key and collects its problems, so that all errors are reported at once.
///
/// A reader returns the value, or a harmless default after it has added an error to `problems`: check `problems` before
/// using the values. Numbers may be quoted, because the parameter server and the command line pass strings.
class Section {
public:
  /// `path` names the section in messages; empty for the document itself.
  Section(const YAML::Node& node, const std::string& path, std::vector<std::string>& problems);

  /// False if the section is missing or not a mapping, which is already reported.
  bool is_mapping() const { return node_.IsMap(); }

  /// Whether an optional key is given.
  bool has(const std::string& key);

  double number(const std::string& key, const Allowed& allowed);
  std::int64_t integer(const std::string& key, std::int64_t least, std::int64_t most);
  bool boolean(const std::string& key);
  std::string text(const std::string& key, const std::string& allowed = "a text");
  std::string choice(const std::string& key, const std::vector<std::string>& choices);
  /// A non-empty list of finite numbers, at most `longest`.
  Eigen::VectorXd numbers(const std::string& key, Eigen::Index longest = std::numeric_limits<Eigen::Index>::max());
  /// A non-empty list of rows of finite numbers, all of one length; at most kLongestRow rows and columns.
  Eigen::MatrixXd matrix(const std::string& key);
  /// A non-empty list of names.
  std::vector<std::string> texts(const std::string& key);
  Section section(const std::string& key);
  /// A list of mappings, possibly empty.
  std::vector<Section> sections(const std::string& key);

  /// All keys of this mapping; they all count as known.
  std::vector<std::string> keys();

  /// Whether the value at an optional key is a list.
  bool is_list(const std::string& key);

  /// Adds a problem whose text begins with the key.
  void report(const std::string& problem) { problems_.push_back(name(problem)); }

  /// Adds a problem of the section as a whole.
  void report_whole(const std::string& problem) { problems_.push_back((path_.empty() ? "" : path_ + ": ") + problem); }

  /// Number of errors so far in the whole document.
  std::size_t problems() const { return problems_.size(); }

  /// Name of a key of this section in messages.
  std::string name(const std::string& key) const { return path_.empty() ? key : path_ + "/" + key; }

  /// Reports all keys that were not read or occur twice. Call it last.
  void reject_unknown_keys();

  /// Reports a value at `key` that is not allowed.
  void reject(const std::string& key, const std::string& value, const std::string& allowed);

private:
  YAML::Node require(const std::string& key, const std::string& allowed);

  const YAML::Node node_;
  std::string path_;
  std::vector<std::string>& problems_;
  std::set<std::string> known_;
};

}  // namespace platoon
