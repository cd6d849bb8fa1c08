#include "tools/settings.hpp"

#include <algorithm>
#include <boost/program_options.hpp>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "stochastic_platoon/configuration/settings.hpp"
#include "stochastic_platoon/configuration/version.hpp"

namespace platoon {

namespace {

namespace options = boost::program_options;

std::string help_of(const std::string& name) {
  if (name == "model") return "model file (YAML); without it the paper's example";
  for (const Setting& setting : settings()) {
    const std::string value = setting.default_value;
    if (name == setting.name) return setting.help + (value.empty() ? "" : " (" + value + ")");
  }
  throw std::logic_error(name + ": is no setting");
}

// The settings are named as the launch arguments, the options as is usual on a command line.
std::string option_name(std::string setting) {
  std::replace(setting.begin(), setting.end(), '_', '-');
  return setting;
}

}  // namespace

std::map<std::string, std::string> parse_command_line(int argc, char** argv, const std::string& purpose,
                                                      const std::set<std::string>& accepted,
                                                      const std::map<std::string, std::string>& extra) {
  std::map<std::string, std::string> help = extra;
  for (const std::string& name : accepted) help[name] = help_of(name);
  options::options_description description(purpose);
  description.add_options()("help", "print this")("version", "print the version");
  for (const auto& entry : help) {
    description.add_options()(option_name(entry.first).c_str(), options::value<std::string>(),
                              entry.second.c_str());
  }
  std::map<std::string, std::string> given;
  try {
    options::variables_map values;
    // No abbreviations: a mistyped option must not be taken for another.
    const int style = options::command_line_style::unix_style & ~options::command_line_style::allow_guessing;
    const options::positional_options_description no_positionals;
    options::store(options::command_line_parser(argc, argv)
                       .options(description)
                       .positional(no_positionals)
                       .style(style)
                       .run(),
                   values);
    if (values.count("help") > 0) {
      std::cout << description;
      std::exit(0);
    }
    if (values.count("version") > 0) {
      std::cout << "stochastic_platoon " << kVersion << "\n";
      std::exit(0);
    }
    for (const auto& entry : help) {
      if (values.count(option_name(entry.first)) > 0)
        given[entry.first] = values[option_name(entry.first)].as<std::string>();
    }
  } catch (const options::error& error) {
    std::cerr << argv[0] << ": " << error.what() << "; --help lists the options\n";
    std::exit(2);
  }
  return given;
}

std::string paper_model_file() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path installed =
      program.parent_path() / "../../share/stochastic_platoon/config/paper.yaml";
  if (std::filesystem::exists(installed)) return installed.lexically_normal().string();
  return PLATOON_SOURCE_DIR "/config/paper.yaml";
}

}  // namespace platoon
