#include "stochastic_platoon/run/configuration/yaml_file.hpp"

#include <yaml-cpp/eventhandler.h>

#include <sstream>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"

namespace platoon {

namespace {

/// Remembers where a document starts, and whether one has an alias.
class DocumentStart : public YAML::EventHandler {
public:
  int line = 0;  ///< from 0
  bool has_alias = false;
  std::size_t values = 0;
  void OnDocumentStart(const YAML::Mark& mark) override { line = mark.line; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override { ++values; }
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override { has_alias = true; }
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override { ++values; }
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    ++values;
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    ++values;
  }
  void OnMapEnd() override {}
};

/// Copies nodes so that an alias has a value of its own: an override of one place must not change others.
class Unshared {
public:
  /// `values`: of the file, each alias as one.
  Unshared(const std::string& name, std::size_t values) : name_(name), most_(values + kMost) {}

  YAML::Node operator()(const YAML::Node& node, int depth = 0) {
    constexpr int kDeepest = 100;  // an alias may stand for a mapping that contains it
    if (++values_ > most_ || depth > kDeepest)
      throw ConfigurationError({name_ + ": aliases stand for more than " + std::to_string(kMost) + " values or " +
                                std::to_string(kDeepest) + " levels: must be fewer"});
    if (!node.IsMap() && !node.IsSequence()) return YAML::Clone(node);
    YAML::Node copy(node.Type());
    for (const auto& entry : node) {
      if (node.IsMap())
        copy.force_insert(YAML::Clone(entry.first), (*this)(entry.second, depth + 1));
      else
        copy.push_back((*this)(entry, depth + 1));
    }
    return copy;
  }

private:
  static constexpr std::size_t kMost = 100000;

  const std::string& name_;
  std::size_t most_, values_ = 0;
};

}  // namespace

YAML::Node parse_yaml(const std::string& text, const std::string& name) {
  try {
    const YAML::Node document = YAML::Load(text);
    // YAML::Load ignores further documents, such as all text behind a mapping in braces. At most two are read here, as
    // YAML::LoadAll does not terminate on some files.
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    DocumentStart start;
    if (parser.HandleNextDocument(start) && parser.HandleNextDocument(start))
      throw ConfigurationError(
          {name + ": several documents, one from line " + std::to_string(start.line + 1) + " on: must be one"});
    return start.has_alias ? Unshared(name, start.values)(document) : document;
  } catch (const YAML::Exception& error) {
    throw ConfigurationError({name + ": must be YAML: " + error.what()});
  }
}

YAML::Node load_yaml(const std::string& file, const std::string& what) {
  try {
    // yaml-cpp's own LoadFile leaks memory if reading fails midway, and never returns for an endless file.
    return parse_yaml(read_file(file, kMostGivenBytes), what + ": " + file);
  } catch (const UnreadableFile& error) {
    throw ConfigurationError({what + ": " + error.what()});
  }
}

}  // namespace platoon
