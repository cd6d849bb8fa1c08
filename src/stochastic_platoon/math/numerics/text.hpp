#pragma once

#include <string>

namespace platoon {

/// printf to a string of any length.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// The value to six digits, or as "1 - 2.5e-10" if six digits would show 1.
std::string beside_one(double value);

}  // namespace platoon
