#pragma once

#include <string>

namespace platoon {

/// printf to a string of any length.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// The text with every byte that is no printable ASCII as \xNN: for what comes from files.
std::string printable(const std::string& text);

}  // namespace platoon
