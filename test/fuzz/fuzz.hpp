#pragma once

#include <cstdint>
#include <string>

#include "unit/temporary_folder.hpp"

namespace platoon::fuzz {

/// A folder of this process, removed when the process exits normally.
inline const TemporaryFolder& folder() {
  static const TemporaryFolder made;
  return made;
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Writes these bytes to a file and returns its name.
inline std::string file_of(const std::uint8_t* data, std::size_t size) {
  return folder().file("input", text_of(data, size));
}

}  // namespace platoon::fuzz
