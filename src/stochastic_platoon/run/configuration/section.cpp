#include "stochastic_platoon/run/configuration/section.hpp"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/yaml_value.hpp"

namespace platoon {

namespace {

constexpr char kUtf8[] = "UTF-8 without a zero byte", kMapping[] = ": must be a mapping of keys";

constexpr char kDecimalPoint[] = ", with a decimal point in place of the comma",
               kWholeWithPoint[] = "one number, with a decimal point in place of the comma";

// A section may be read more than once.
void add_once(std::vector<std::string>& problems, const std::string& problem) {
  if (std::find(problems.begin(), problems.end(), problem) == problems.end()) problems.push_back(problem);
}

std::string at_most(double most) {
  return formatted("at most %g in magnitude", most);
}

}  // namespace

const Allowed kAnyFinite{"a finite number"};
const Allowed kPositive{"a finite number > 0", kAboveZero};
const Allowed kNotNegative{"a finite number >= 0", 0.0};
const Allowed kLossProbability{"a number from 0 to below 1", 0.0, kLargest, 1.0};

Section::Section(const YAML::Node& node, const std::string& path, std::vector<std::string>& problems)
    : node_(node), path_(path), problems_(problems) {
  if (node_.IsNull() && !path.empty()) return;  // missing, and already reported
  if (node_.IsMap()) return;
  add_once(problems_, (path.empty() ? "the document" : path) + ": " + shown(node) + kMapping);
}

bool Section::has(const std::string& key) {
  known_.insert(key);
  return node_.IsMap() && node_[key];
}

void Section::reject(const std::string& key, const std::string& value, const std::string& allowed) {
  problems_.push_back(name(key) + ": " + value + ": must be " + allowed);
}

YAML::Node Section::require(const std::string& key, const std::string& allowed) {
  known_.insert(key);
  if (!node_.IsMap()) return {};
  const YAML::Node value = node_[key];
  if (!value || value.IsNull()) {
    problems_.push_back(name(key) + ": missing: must be " + allowed);
    return {};
  }
  return value;
}

double Section::number(const std::string& key, const Allowed& allowed) {
  const YAML::Node node = require(key, allowed.text);
  if (node.IsNull()) return 1.0;
  const std::optional<double> value = parsed_number(node);
  if (!value || *value < allowed.least || *value >= allowed.below) {
    reject(key, shown(node), allowed.text + (has_decimal_comma(node) ? kDecimalPoint : ""));
    return 1.0;
  }
  if (std::abs(*value) > allowed.most) {
    reject(key, shown(node), at_most(allowed.most));
    return 1.0;
  }
  return *value;
}

std::int64_t Section::integer(const std::string& key, std::int64_t least, std::int64_t most) {
  const std::string allowed = "a whole number from " + std::to_string(least) + " to " + std::to_string(most);
  const YAML::Node node = require(key, allowed);
  if (node.IsNull()) return least;
  const std::optional<std::int64_t> value = parsed_integer(node);
  if (!value || *value < least || *value > most) {
    reject(key, shown(node), allowed);
    return least;
  }
  return *value;
}

bool Section::boolean(const std::string& key) {
  const YAML::Node node = require(key, "true or false");
  if (node.IsNull()) return false;
  const std::optional<bool> value = parsed_boolean(node);
  if (!value) reject(key, shown(node), "true or false");
  return value.value_or(false);
}

std::string Section::text(const std::string& key, const std::string& allowed) {
  const YAML::Node node = require(key, allowed);
  if (node.IsNull()) return "";
  if (!node.IsScalar()) {
    reject(key, shown(node), allowed);
    return "";
  }
  if (!is_text(node.Scalar())) reject(key, shown(node), kUtf8);
  return node.Scalar();
}

std::string Section::choice(const std::string& key, const std::vector<std::string>& choices) {
  const std::string allowed = boost::algorithm::join(choices, " or ");
  const YAML::Node node = require(key, allowed);
  if (node.IsNull()) return choices.front();
  std::string text = node.IsScalar() ? node.Scalar() : "";
  if (std::find(choices.begin(), choices.end(), text) != choices.end()) return text;
  reject(key, shown(node), allowed);
  return choices.front();
}

Eigen::VectorXd Section::numbers(const std::string& key, Eigen::Index longest) {
  const std::string allowed = "a list of finite numbers";
  const YAML::Node node = require(key, allowed);
  if (node.IsNull()) return Eigen::VectorXd::Ones(1);
  const std::optional<Eigen::VectorXd> values = parsed_numbers(node);
  if (!values) {
    reject(key, shown(node), allowed);
  } else if (values->size() > longest) {
    reject(key, std::to_string(values->size()) + " numbers", "at most " + std::to_string(longest));
  } else if (values->cwiseAbs().maxCoeff() > kLargest) {
    reject(key, shown(node), at_most(kLargest));
  } else {
    return *values;
  }
  return Eigen::VectorXd::Ones(1);
}

Eigen::MatrixXd Section::matrix(const std::string& key) {
  const std::string allowed = "a list of rows of finite numbers, all of one length";
  const YAML::Node node = require(key, allowed);
  if (node.IsNull()) return Eigen::MatrixXd::Ones(1, 1);
  constexpr auto kLongest = static_cast<std::size_t>(kLongestRow);
  const std::size_t rows = node.IsSequence() ? node.size() : 0;
  if (rows > kLongest || (rows > 0 && node[0].size() > kLongest)) {
    reject(key, std::to_string(rows) + " rows of " + std::to_string(node[0].size()),
           "at most " + std::to_string(kLongestRow) + " x " + std::to_string(kLongestRow));
    return Eigen::MatrixXd::Ones(1, 1);
  }
  Eigen::MatrixXd values;
  for (std::size_t i = 0; i < rows; ++i) {
    const std::optional<Eigen::VectorXd> row = parsed_numbers(node[i]);
    if (!row || (i > 0 && row->size() != values.cols())) {
      values.resize(0, 0);
      break;
    }
    values.conservativeResize(values.rows() + 1, row->size());
    values.bottomRows(1) = row->transpose();
  }
  if (values.size() > 0 && values.cwiseAbs().maxCoeff() <= kLargest) return values;
  reject(key, shown(node), values.size() > 0 ? at_most(kLargest) : allowed);
  return Eigen::MatrixXd::Ones(1, 1);
}

std::vector<std::string> Section::texts(const std::string& key) {
  const std::string allowed = "a list of names, not empty";
  const YAML::Node node = require(key, allowed);
  if (node.IsNull()) return {};
  std::vector<std::string> values;
  for (std::size_t i = 0; node.IsSequence() && i < node.size(); ++i) {
    if (!node[i].IsScalar()) {
      values.clear();
      break;
    }
    values.push_back(node[i].Scalar());
    if (is_text(values.back())) continue;
    reject(key, shown(node), kUtf8);
    return {};
  }
  if (values.empty()) reject(key, shown(node), allowed);
  return values;
}

std::vector<std::string> Section::keys() {
  std::vector<std::string> found;
  if (!node_.IsMap()) return found;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) continue;
    if (!is_text(entry.first.Scalar())) {
      known_.insert(entry.first.Scalar());
      problems_.push_back(name(shown(entry.first)) + ": must be " + kUtf8);
    } else if (known_.insert(entry.first.Scalar()).second) {
      found.push_back(entry.first.Scalar());
    }
  }
  return found;
}

bool Section::is_list(const std::string& key) {
  return has(key) && node_[key].IsSequence();
}

Section Section::section(const std::string& key) {
  const YAML::Node node = has(key) ? node_[key] : YAML::Node();
  if (node_.IsMap() && node.IsNull()) add_once(problems_, name(key) + ": missing" + kMapping);
  return Section(node, name(key), problems_);
}

std::vector<Section> Section::sections(const std::string& key) {
  const YAML::Node node = require(key, "a list of mappings");
  if (node.IsNull()) return {};
  if (!node.IsSequence()) reject(key, shown(node), "a list of mappings");
  std::vector<Section> entries;
  for (std::size_t i = 0; node.IsSequence() && i < node.size(); ++i) {
    const std::string entry = name(key) + "[" + std::to_string(i) + "]";
    if (node[i].IsNull()) problems_.push_back(entry + ": (nothing): must be a mapping of keys");
    entries.emplace_back(node[i], entry, problems_);
  }
  return entries;
}

void Section::reject_unknown_keys() {
  if (!node_.IsMap()) return;
  const std::string allowed = boost::algorithm::join(known_, ", ");
  std::set<std::string> seen;
  YAML::const_iterator before = node_.end();
  for (auto at = node_.begin(); at != node_.end(); before = at++) {
    const auto& entry = *at;
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : shown(entry.first);
    // In {kp: 0,2} the comma begins the key 2.
    if (known_.count(key) == 0 && is_digits(key) && entry.second.IsNull() && before != node_.end()) {
      const YAML::const_iterator::value_type number = *before;  // not before->, which refers into a temporary
      if (number.second.IsScalar() && is_digits(number.second.Scalar())) {
        reject(shown(number.first), number.second.Scalar() + "," + key, kWholeWithPoint);
        continue;
      }
    }
    if (known_.count(key) == 0) problems_.push_back(name(shown(entry.first)) + ": unknown key: allowed are " + allowed);
    if (!seen.insert(key).second) problems_.push_back(name(key) + ": given twice: must be given once");
  }
}

}  // namespace platoon
