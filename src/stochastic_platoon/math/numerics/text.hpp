#pragma once

#include <string>

namespace platoon {

/// printf to a string of any length.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// The value to six digits, or as "1 - 2.5e-10" if six digits would show 1.
std::string beside_one(double value);

/// The text, or the beginning of a long text and "...", to identify a value in a message.
std::string shortened(const std::string& text);

/// The text with every byte outside printable ASCII as `\xNN`, for text read from files.
std::string printable(const std::string& text);

}  // namespace platoon
