#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/command_line.hpp"

namespace platoon {

/// Throws ConfigurationError if a vehicle runs already that this launch would start, the options `first` to `last` of
/// the namespace `ns` without the external ones. Without a launch nothing is checked, as in the next function.
void require_free_vehicles(const CommandLine& line, const std::vector<std::size_t>& external);

/// The same, and if a platoon runs in the namespace. `external`: none if the launch's vehicles are not known.
void require_free_namespace(const CommandLine& line, const std::optional<std::vector<std::size_t>>& external);

}  // namespace platoon
