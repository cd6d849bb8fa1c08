#include "stochastic_platoon/run/configuration/yaml_file.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"

namespace platoon {

namespace {

// yaml-cpp's own LoadFile leaks memory if reading fails midway, and never returns for an endless file.
std::string text_of(const std::string& file, const std::string& what) {
  constexpr std::size_t kMegabyte = 1000000, kMost = 256 * kMegabyte;
  std::ifstream stream(file, std::ios::binary);
  std::string text, part(kMegabyte, '\0');
  do {
    stream.read(part.data(), static_cast<std::streamsize>(part.size()));
    text.append(part, 0, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kMost) throw ConfigurationError({what + ": " + file + ": must have at most 256 MB"});
  } while (stream);
  if (!stream.eof()) throw ConfigurationError({what + ": " + file + ": must be a file that can be read"});
  return text;
}

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
  if (std::filesystem::is_directory(file))
    throw ConfigurationError({what + ": " + file + ": must be a file, not a folder"});
  const std::string text = text_of(file, what);
  try {
    const YAML::Node document = YAML::Load(text);
    if (holds_several_documents(text))
      throw ConfigurationError({what + ": " + file + ": several documents: must be one"});
    return document;
  } catch (const YAML::Exception& error) {
    throw ConfigurationError({what + ": " + file + ": must be YAML: " + error.what()});
  }
}

}  // namespace platoon
