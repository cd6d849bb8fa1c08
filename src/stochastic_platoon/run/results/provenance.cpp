#include "stochastic_platoon/run/results/provenance.hpp"

#include <unistd.h>

#include <array>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"

namespace platoon {

namespace {

// Empty if it cannot be read: a process may end at any time.
std::string content_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();  // iterators would throw if a read fails
  return text.str();
}

std::vector<std::string> command_line_of(long process) {
  std::istringstream text(content_of("/proc/" + std::to_string(process) + "/cmdline"));
  std::vector<std::string> words;
  for (std::string word; std::getline(text, word, '\0');) words.push_back(word);
  return words;
}

// 0 at the end of the line of ancestors. The name of the program, in parentheses, may contain anything.
long parent_of(long process) {
  const std::string text = content_of("/proc/" + std::to_string(process) + "/stat");
  const std::size_t end = text.rfind(')');
  if (end == std::string::npos) return 0;
  std::istringstream fields(text.substr(end + 1));
  std::string state;
  long parent = 0;
  fields >> state >> parent;
  return parent;
}

bool is_roslaunch(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (std::filesystem::path(word).filename() == "roslaunch") return true;
  }
  return false;
}

std::string date_now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

std::string host() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

}  // namespace

long roslaunch_process() {
  long process = ::getpid();
  while (process > 0 && !is_roslaunch(command_line_of(process))) process = parent_of(process);
  return process;
}

std::vector<std::string> command_line() {
  const long roslaunch = roslaunch_process();
  return command_line_of(roslaunch > 0 ? roslaunch : ::getpid());
}

nlohmann::json provenance(const Configuration& configuration) {
  return {{"configuration", to_json(configuration)},
          {"revision", kRevision},
          {"date", date_now()},
          {"host", host()},
          {"command_line", command_line()}};
}

Configuration recorded_configuration(nlohmann::json document) {
  nlohmann::json& hosting = document.at("run").at("hosting");
  if (hosting == to_string(Hosting::monte_carlo) || hosting == to_string(Hosting::bag))
    hosting = to_string(Hosting::one_process);
  return parse_recorded_configuration(document.dump());
}

RecordedResults read_summary(const std::string& file) {
  const nlohmann::json summary = parse_summary(read_file(file, kMostWrittenBytes), file);
  if (!summary.contains("complete")) throw std::invalid_argument(file + ": must be the summary.json of a run");
  if (!summary.contains("configuration"))
    throw std::invalid_argument(file + ": states no configuration: written by an older version");
  nlohmann::json checksums = summary.at("crc32");
  checksums.erase("summary");
  return {recorded_configuration(summary["configuration"]), summary.at("complete").get<bool>(),
          summary.at("realizations").get<std::uint64_t>(), checksums};
}

std::string part_of_run(const RunOptions& run, std::uint64_t realizations) {
  if (realizations >= run.realizations || run.averaging() == Averaging::over_time) return "";
  return formatted(
      "realizations %llu to %llu of %llu", static_cast<unsigned long long>(run.realizations - realizations),
      static_cast<unsigned long long>(run.realizations - 1), static_cast<unsigned long long>(run.realizations));
}

}  // namespace platoon
