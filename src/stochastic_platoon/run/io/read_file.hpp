#pragma once

#include <string>

namespace platoon {

/// The content of a file. Throws std::system_error, with the system's reason, if it cannot be read.
std::string read_file(const std::string& file);

}  // namespace platoon
