#include "tools/settings.hpp"

#include <algorithm>
#include <boost/program_options.hpp>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <thread>

#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"

namespace platoon {

namespace {

namespace options = boost::program_options;

std::string help_of(const std::string& name) {
  if (name == "model")
    return "model file (YAML), or the name of a shipped one as acc.yaml; without it the paper's example";
  for (const Setting& setting : settings()) {
    const std::string value = setting.default_value;
    if (name == setting.name) return setting.help + (value.empty() ? "" : " (" + value + ")");
  }
  throw std::logic_error(name + ": is no setting");
}

// Settings have the names of launch arguments; options have hyphens, as usual on a command line.
std::string option_name(std::string setting) {
  std::replace(setting.begin(), setting.end(), '_', '-');
  return setting;
}

}  // namespace

std::map<std::string, std::string> parse_command_line(int argc, char** argv, const std::string& purpose,
                                                      const std::set<std::string>& accepted,
                                                      const std::map<std::string, std::string>& extra,
                                                      std::vector<std::string>* words,
                                                      const std::set<std::string>& flags) {
  std::map<std::string, std::string> help = extra;
  for (const std::string& name : accepted) help[name] = help_of(name);
  options::options_description description(purpose);
  description.add_options()("help,h", "print this")("version", "print the version");
  for (const auto& entry : help) {
    const auto value = options::value<std::string>();
    if (flags.count(entry.first) > 0) value->implicit_value("true", "");
    description.add_options()(option_name(entry.first).c_str(), value, entry.second.c_str());
  }
  std::map<std::string, std::string> given;
  try {
    options::variables_map values;
    // No abbreviations: a mistyped option must not match another one.
    const int style = options::command_line_style::unix_style & ~options::command_line_style::allow_guessing;
    options::options_description known = description;
    options::positional_options_description positionals;
    if (words != nullptr) {
      known.add_options()("word", options::value(words));
      positionals.add("word", -1);
    }
    options::store(options::command_line_parser(argc, argv).options(known).positional(positionals).style(style).run(),
                   values);
    if (values.count("help") > 0) {
      std::cout << description;
      std::exit(0);
    }
    if (values.count("version") > 0) {
      std::cout << "stochastic_platoon " << kVersion << "\n";
      std::exit(0);
    }
    options::notify(values);
    for (const auto& entry : help) {
      if (values.count(option_name(entry.first)) > 0)
        given[entry.first] = values[option_name(entry.first)].as<std::string>();
    }
  } catch (const options::error& error) {
    std::cerr << argv[0] << ": " << error.what() << "; --help lists the options\n";
    std::exit(2);
  }
  for (const auto& [name, folder] : {std::pair("model", "config"), std::pair("leader", "config/leaders")}) {
    const auto file = given.find(name);
    if (file != given.end()) file->second = shipped_file(file->second, folder);
  }
  return given;
}

unsigned threads_of(const std::string& text) {
  if (text.empty()) return std::max(std::thread::hardware_concurrency(), 1u);
  YAML::Node node;
  node["threads"] = text;
  std::vector<std::string> problems;
  const std::int64_t threads = Section(node, "", problems).integer("threads", 1, 1024);
  if (!problems.empty()) throw ConfigurationError(problems);
  return static_cast<unsigned>(threads);
}

void log_slow_noise(const char* program) {
  const std::string reason = slow_noise();
  if (!reason.empty()) std::cerr << program << ": " << reason << "\n";
}

double seconds_of(const std::string& option, const std::string& text) {
  YAML::Node node;
  node[option] = text;
  std::vector<std::string> problems;
  const double seconds = Section(node, "", problems).number(option, kPositive);
  if (!problems.empty()) throw ConfigurationError(problems);
  return seconds;
}

}  // namespace platoon
