#include "stochastic_platoon/run/configuration/yaml_file.hpp"

#include <yaml-cpp/eventhandler.h>

#include <sstream>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"

namespace platoon {

namespace {

/// Remembers where a document starts.
class DocumentStart : public YAML::EventHandler {
public:
  int line = 0;  ///< from 0
  void OnDocumentStart(const YAML::Mark& mark) override { line = mark.line; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

// Reads at most two documents, as yaml-cpp's own LoadAll does not terminate on some files. Text behind a mapping in
// braces, which YAML::Load ignores, is a document too.
void expect_one_document(const std::string& text, const std::string& file) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentStart start;
  if (parser.HandleNextDocument(start) && parser.HandleNextDocument(start))
    throw ConfigurationError(
        {file + ": several documents, one from line " + std::to_string(start.line + 1) + " on: must be one"});
}

}  // namespace

YAML::Node load_yaml(const std::string& file, const std::string& what) {
  try {
    // yaml-cpp's own LoadFile leaks memory if reading fails midway, and never returns for an endless file.
    const std::string text = read_file(file, kMostGivenBytes);
    const YAML::Node document = YAML::Load(text);
    expect_one_document(text, what + ": " + file);
    return document;
  } catch (const UnreadableFile& error) {
    throw ConfigurationError({what + ": " + error.what()});
  } catch (const YAML::Exception& error) {
    throw ConfigurationError({what + ": " + file + ": must be YAML: " + error.what()});
  }
}

}  // namespace platoon
