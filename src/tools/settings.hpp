#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace platoon {

/// The command line of a tool: --name value for every setting of the platoon (see settings()) named
/// in `accepted`, and for the tool's own `extra` options (name -> help). Values are checked by the
/// configuration's parser, not here.
///
/// `words`: what stands without a name, for a tool that takes such; for others that is an error.
///
/// Prints the help or the version and exits for --help and --version; prints what is wrong and exits with
/// status 2 for an unknown option.
std::map<std::string, std::string> parse_command_line(int argc, char** argv, const std::string& purpose,
                                                      const std::set<std::string>& accepted,
                                                      const std::map<std::string, std::string>& extra,
                                                      std::vector<std::string>* words = nullptr);

/// The value of the option `threads`: one per core where nothing is asked for. Throws ConfigurationError.
unsigned threads_of(const std::string& text);

/// The value of an option that is a time above 0 [s]. Throws ConfigurationError.
double seconds_of(const std::string& option, const std::string& text);

/// The paper's example as shipped with this program: of the install space if it runs there, else of the
/// source folder.
std::string paper_model_file();

}  // namespace platoon
