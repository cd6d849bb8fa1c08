#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace platoon {

/// The command line that a tool accepts, besides --help and --version.
struct AcceptedOptions {
  std::string purpose;                           ///< first lines of the help
  std::set<std::string> settings;                ///< of the platoon, see settings()
  std::map<std::string, std::string> options;    ///< of the tool, with their help
  bool words = false;                            ///< whether arguments without a name are accepted
  std::set<std::string> flags = {};              ///< those of `options` that take no value
  std::map<std::string, std::string> help = {};  ///< of settings that have another meaning in this tool
};

/// A parsed command line: its values by the names in AcceptedOptions.
struct CommandLine {
  std::map<std::string, std::string> settings, options;
  std::vector<std::string> words;

  /// The value of the setting, empty if it is not given.
  std::string setting(const std::string& name) const {
    const auto found = settings.find(name);
    return found == settings.end() ? "" : found->second;
  }

  /// Whether the option is given.
  bool has(const std::string& option) const { return options.count(option) > 0; }

  /// The value of the option, empty if it is not given.
  std::string operator[](const std::string& option) const { return has(option) ? options.at(option) : ""; }
};

/// Parses --name value for all accepted names, in which hyphens replace underscores. A `model` or `leader` without a
/// folder names the shipped file unless the working folder has such a file.
///
/// Prints the help or the version and exits for --help and --version; prints the error and exits with status 2 for an
/// unknown option.
CommandLine parse_command_line(int argc, char** argv, const AcceptedOptions& accepted);

/// The name on the command line: settings have the names of launch arguments, and options hyphens in place of their
/// underscores.
std::string option_name(std::string name);

/// The help of `steps` in tools without endless runs.
extern const char* const kStepsHelp;

/// Throws ConfigurationError if the setting `steps` is 0, as only launches have endless runs; "must be at least 1
/// WHERE".
void require_steps(const CommandLine& line, const std::string& where);

/// The number of worker threads that the option `threads` gives, by default one per core. Throws ConfigurationError.
unsigned threads_of(const CommandLine& line);

}  // namespace platoon
