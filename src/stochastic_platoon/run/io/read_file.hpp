#pragma once

#include <cstdint>
#include <string>

namespace platoon {

/// The content of a file. Throws std::system_error, with the system's reason, if it cannot be read or has more than
/// `most` bytes.
std::string read_file(const std::string& file, std::size_t most = SIZE_MAX);

}  // namespace platoon
