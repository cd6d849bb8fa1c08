#pragma once

#include <string>

namespace platoon {

/// printf to a string of any length.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace platoon
