#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace platoon {

/// Parses the command line of a tool: --name value for every setting of the platoon (see settings()) in `accepted`, and
/// for the tool's own `extra` options (name -> help). The configuration's parser checks the values.
///
/// A `model` or `leader` without a folder names the shipped file unless the working folder has such a file.
///
/// `words`: receives arguments without a name; null: such arguments are an error. `flags`: those of the `extra` options
/// that take no value; a given one has the value "true".
///
/// Prints the help or the version and exits for --help and --version; prints the error and exits with status 2 for an
/// unknown option.
std::map<std::string, std::string> parse_command_line(int argc, char** argv, const std::string& purpose,
                                                      const std::set<std::string>& accepted,
                                                      const std::map<std::string, std::string>& extra,
                                                      std::vector<std::string>* words = nullptr,
                                                      const std::set<std::string>& flags = {});

/// The value of the option `threads`; for an empty text one per core. Throws ConfigurationError.
unsigned threads_of(const std::string& text);

/// The value of an option that is a time above 0 [s]. Throws ConfigurationError.
double seconds_of(const std::string& option, const std::string& text);

/// Logs that the noise is slow on this machine, and why.
void log_slow_noise(const char* program);

}  // namespace platoon
