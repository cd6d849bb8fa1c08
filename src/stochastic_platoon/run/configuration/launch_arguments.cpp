#include "stochastic_platoon/run/configuration/launch_arguments.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <numeric>
#include <optional>
#include <regex>
#include <set>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"

namespace platoon {

namespace {

constexpr char kPackage[] = "stochastic_platoon";

std::string without_comments(std::string text) {
  for (std::size_t begin = text.find("<!--"); begin != std::string::npos; begin = text.find("<!--", begin)) {
    const std::size_t end = text.find("-->", begin);
    text.erase(begin, end == std::string::npos ? end : end + 3 - begin);
  }
  return text;
}

// With pass_all_args an include takes every argument that the included file declares.
void add_declared(const std::filesystem::path& file, const std::string& folder, std::set<std::string>& names) {
  static const std::regex argument(R"re(<arg\s+name="([^"]+)")re"), include(R"re(<include\s[^>]*>)re"),
      included(R"re(file="[^"]*/([^"/]+)")re");
  const std::string text = without_comments(read_file(file.string(), kMostGivenBytes));
  for (std::sregex_iterator found(text.begin(), text.end(), argument), end; found != end; ++found)
    names.insert((*found)[1]);
  for (std::sregex_iterator found(text.begin(), text.end(), include), end; found != end; ++found) {
    const std::string element = found->str();
    std::smatch name;
    if (element.find("pass_all_args=\"true\"") == std::string::npos || !std::regex_search(element, name, included))
      continue;
    const std::filesystem::path next = std::filesystem::path(folder) / name[1].str();
    if (may_exist(next.string()) && next.filename() != file.filename()) add_declared(next, folder, names);
  }
}

// The launch file that a word names: a file, or one of this package if the word before it is the package.
std::optional<std::filesystem::path> launch_file(const std::string& word, const std::string& before,
                                                 const std::string& folder) {
  const std::string extension = std::filesystem::path(word).extension();
  if (extension != ".launch" && extension != ".xml") return std::nullopt;
  if (before == kPackage) {
    const std::filesystem::path shipped = std::filesystem::path(folder) / word;
    if (may_exist(shipped.string())) return shipped;
  }
  if (may_exist(word)) return std::filesystem::path(word);
  return std::nullopt;
}

/// Levenshtein's distance: the least number of letters to insert, remove or replace.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::vector<std::string> undeclared_arguments(const std::vector<std::string>& command_line, const std::string& folder) {
  const auto program = std::find_if(command_line.begin(), command_line.end(), [](const std::string& word) {
    return std::filesystem::path(word).filename() == "roslaunch";
  });
  if (program == command_line.end()) return {};
  static const std::regex assignment("([A-Za-z][A-Za-z0-9_]*):=[^]*");  // but not __name:=
  std::set<std::string> declared;
  std::vector<std::string> given;
  std::string file_name;
  for (auto word = program + 1; word != command_line.end(); ++word) {
    std::smatch name;
    if (std::regex_match(*word, name, assignment)) {
      given.push_back(name[1]);
    } else if (const auto file = launch_file(*word, *(word - 1), folder)) {
      add_declared(*file, folder, declared);
      file_name += (file_name.empty() ? "" : ", ") + file->filename().string();
    } else if (std::filesystem::path(*word).extension() == ".launch") {
      return {};  // of another package
    }
  }
  if (file_name.empty()) return {};
  std::vector<std::string> problems;
  for (const std::string& name : given) {
    if (declared.count(name) > 0) continue;
    std::string problem = name + ": unknown argument of " + file_name;
    const auto nearest = std::min_element(declared.begin(), declared.end(), [&](const auto& a, const auto& b) {
      return distance(a, name) < distance(b, name);
    });
    if (nearest != declared.end() && distance(*nearest, name) <= std::max<std::size_t>(2, name.size() / 3))
      problem += ": did you mean " + *nearest + "?";
    problems.push_back(problem + " (roslaunch --ros-args lists the arguments)");
  }
  return problems;
}

std::vector<std::string> ineffective_arguments(std::map<std::string, std::string> given) {
  ProblemCollector problems;
  const auto number = [&](const char* option, const char* name, double otherwise, const Allowed& allowed) {
    if (given[option].empty()) return otherwise;
    return problems.result_of([&] { return number_of(name, given[option], allowed); }).value_or(otherwise);
  };
  const auto reject = [&](bool is_given, const std::string& name, const std::string& allowed) {
    if (is_given) problems.add(name + ": given: must be " + allowed);
  };
  constexpr double kPatience = 60.0;  // default of replay.launch [s]
  const std::string drive = given["drive"], prefix = "vehicle_", external = given["external"];
  const bool all = drive.empty(), one = drive.compare(0, prefix.size(), prefix) == 0;
  const double rate = number("replay_rate", "rate", 0.0, kNotNegative),
               start = number("start", "start", 0.0, kNotNegative);
  const std::string without = "without drive:=" + drive;
  reject(!all && start != 0.0, "start", without);
  reject(all && start != 0.0 && rate == 0.0, "start",
         "with a rate above 0, as otherwise all passes as fast as possible");
  reject(!all && is_true(given["pause"]), "pause", without);
  reject(number("patience", "patience", kPatience, kPositive) != kPatience && !one, "patience",
         "with drive:=vehicle_N");
  reject(all && !external.empty(), "external", "with drive:=leader or drive:=vehicle_N");
  if (!one) return problems.all();
  reject(rate != 0.0, "rate", without + ", as the vehicle is driven as fast as it answers");
  for (const char* name : {"dashboard", "stay"})
    reject(is_true(given[name]), name, without + ", which ends with a verdict");
  reject(!given["output"].empty(), "output", without + ", which has no results but a verdict");
  if (const std::string vehicle = drive.substr(prefix.size()); !external.empty() && external != vehicle)
    problems.add("external: " + printable(external) + ": must be " + vehicle + ", the replayed vehicle, or empty");
  return problems.all();
}

void require_port(const std::string& key, const std::string& text) {
  if (!text.empty()) integer_of(key, text, 0, 65535);
}

bool is_true(const std::string& text) {
  return text == "true" || text == "True" || text == "1";
}

std::string master_address(const std::vector<std::string>& command_line, const char* environment) {
  static const std::regex port("(-p|--port=?)([0-9]*)");
  for (auto word = command_line.begin(); word != command_line.end(); ++word) {
    std::smatch found;
    if (!std::regex_match(*word, found, port)) continue;
    if (found[2].length() > 0) return "http://localhost:" + found[2].str();
    if (word + 1 != command_line.end()) return "http://localhost:" + *(word + 1);
  }
  return environment != nullptr ? environment : "http://localhost:11311";
}

}  // namespace platoon
