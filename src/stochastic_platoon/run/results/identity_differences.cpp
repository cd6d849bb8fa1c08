#include "stochastic_platoon/run/results/identity_differences.hpp"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <set>
#include <vector>

#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {

// Appends a sentence for each value that differs. A key in only one of two is a difference, too: the paper's channel
// has no key.
void add_differences(const std::string& path, const nlohmann::json& there, const nlohmann::json& here,
                     std::vector<std::string>& found) {
  if (there == here) return;
  const std::string before = path.empty() ? "" : path + "/";
  if (there.is_object() && here.is_object()) {
    std::set<std::string> keys;
    for (const nlohmann::json* one : {&there, &here}) {
      for (const auto& entry : one->items()) keys.insert(entry.key());
    }
    for (const std::string& key : keys)
      add_differences(before + key, there.value(key, nlohmann::json()), here.value(key, nlohmann::json()), found);
  } else if (there.is_array() && here.is_array() && there.size() == here.size()) {
    for (std::size_t n = 0; n < there.size(); ++n)
      add_differences(before + std::to_string(n), there[n], here[n], found);
  } else {
    found.push_back(path + " is " + shortened(there.dump()) + " there and " + shortened(here.dump()) + " here");
  }
}

}  // namespace

std::string identity_differences(const nlohmann::json& there, const nlohmann::json& here) {
  constexpr std::size_t kMost = 5;
  constexpr char kMatrices[] = "realization";  // follow from the other keys, but for rounding
  nlohmann::json other = there, own = here;
  for (nlohmann::json* one : {&other, &own}) one->erase(kMatrices);
  std::vector<std::string> found;
  add_differences("", other, own, found);
  if (found.empty()) add_differences("", there, here, found);
  const std::size_t others = found.size() - std::min(found.size(), kMost);
  found.resize(found.size() - others);
  return boost::algorithm::join(found, ", ") + (others > 0 ? " (and " + std::to_string(others) + " more)" : "");
}

}  // namespace platoon
