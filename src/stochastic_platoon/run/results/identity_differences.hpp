#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace platoon {

/// Differences of two identities: "seed is 1 there and 2 here"; empty: none.
std::string identity_differences(const nlohmann::json& there, const nlohmann::json& here);

}  // namespace platoon
