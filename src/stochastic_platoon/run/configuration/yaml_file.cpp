#include "stochastic_platoon/run/configuration/yaml_file.hpp"

#include <sstream>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"

namespace platoon {

namespace {

// Looks for separator lines, as yaml-cpp's own LoadAll does not terminate on some files.
bool holds_several_documents(const std::string& text) {
  std::istringstream stream(text);
  bool begun = false;
  for (std::string line; std::getline(stream, line);) {
    const bool separates = line.compare(0, 3, "---") == 0 && (line.size() == 3 || line[3] == ' ' || line[3] == '\r');
    if (separates && begun) return true;
    const std::size_t content = line.find_first_not_of(" \t\r");
    begun = begun || separates || (content != std::string::npos && line[content] != '#' && line[content] != '%');
  }
  return false;
}

}  // namespace

YAML::Node load_yaml(const std::string& file, const std::string& what) {
  try {
    // yaml-cpp's own LoadFile leaks memory if reading fails midway, and never returns for an endless file.
    const std::string text = read_file(file, kMostGivenBytes);
    const YAML::Node document = YAML::Load(text);
    if (holds_several_documents(text))
      throw ConfigurationError({what + ": " + file + ": several documents: must be one"});
    return document;
  } catch (const UnreadableFile& error) {
    throw ConfigurationError({what + ": " + error.what()});
  } catch (const YAML::Exception& error) {
    throw ConfigurationError({what + ": " + file + ": must be YAML: " + error.what()});
  }
}

}  // namespace platoon
