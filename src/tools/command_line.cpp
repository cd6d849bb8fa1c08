#include "tools/command_line.hpp"

#include <algorithm>
#include <boost/program_options.hpp>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <thread>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/configuration/yaml_value.hpp"

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

// Boost would take the next option for the value of one without a value.
void require_values(int argc, char** argv, const options::options_description& known) {
  const auto is_option = [](const std::string& word) { return word.compare(0, 2, "--") == 0 && word.size() > 2; };
  for (int at = 1; at + 1 < argc; ++at) {
    const options::option_description* option = is_option(argv[at]) ? known.find_nothrow(argv[at] + 2, false) : nullptr;
    if (option != nullptr && option->semantic()->min_tokens() > 0 && is_option(argv[at + 1]))
      throw options::error(std::string(argv[at]) + ": " + argv[at + 1] + ": must be a value, not the next option");
  }
}

}  // namespace

const char* const kStepsHelp = "steps per realization, 1 or more; empty: 10 s of driving, from 100 to 10000 steps";

std::string option_name(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

CommandLine parse_command_line(int argc, char** argv, const AcceptedOptions& accepted) {
  std::map<std::string, std::string> help = accepted.options;
  for (const std::string& name : accepted.settings) {
    const auto other = accepted.help.find(name);
    help[name] = other == accepted.help.end() ? help_of(name) : other->second;
  }
  options::options_description description;
  description.add_options()("help,h", "print this")("version", "print the version");
  for (const auto& [name, text] : help) {
    const auto value = options::value<std::string>();
    if (accepted.flags.count(name) > 0) value->implicit_value("true", "")->value_name(" ");
    if (accepted.flags.count(name) > 0 && accepted.words) value->zero_tokens();  // the next word is no value of a flag
    description.add_options()(option_name(name).c_str(), value, text.c_str());
  }
  CommandLine line;
  try {
    options::variables_map values;
    // No abbreviations: a mistyped option must not match another one.
    const int style = options::command_line_style::unix_style & ~options::command_line_style::allow_guessing;
    options::options_description known = description;
    options::positional_options_description positionals;
    if (accepted.words) {
      known.add_options()("word", options::value(&line.words));
      positionals.add("word", -1);
    }
    require_values(argc, argv, known);
    options::store(options::command_line_parser(argc, argv).options(known).positional(positionals).style(style).run(),
                   values);
    if (values.count("help") > 0) {
      std::cout << accepted.purpose << "\n" << description;
      std::exit(0);
    }
    if (values.count("version") > 0) {
      std::cout << "stochastic_platoon " << kVersion << "\n";
      std::exit(0);
    }
    options::notify(values);
    for (const auto& entry : help) {
      const std::string& name = entry.first;
      if (values.count(option_name(name)) == 0) continue;
      (accepted.options.count(name) > 0 ? line.options : line.settings)[name] =
          values[option_name(name)].as<std::string>();
    }
  } catch (const options::error& error) {
    std::cerr << argv[0] << ": " << error.what() << "; --help lists the options\n";
    std::exit(2);
  }
  for (const auto& [name, folder] : {std::pair("model", "config"), std::pair("leader", "config/leaders")}) {
    const auto file = line.settings.find(name);
    if (file != line.settings.end()) file->second = shipped_file(file->second, folder);
  }
  return line;
}

void require_steps(const CommandLine& line, const std::string& where) {
  if (parsed_integer(YAML::Node(line.setting("steps"))) == 0)
    throw ConfigurationError({"steps: 0: must be at least 1 " + where});
}

unsigned threads_of(const CommandLine& line) {
  if (!line.has("threads")) return std::max(std::thread::hardware_concurrency(), 1u);
  return static_cast<unsigned>(integer_of("threads", line["threads"], 1, 1024));
}

}  // namespace platoon
