#pragma once

#include <string>

namespace platoon {

/// printf to a string of any length.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// A number to six digits, or as 1 - 2.5e-10 where these would show 1.
std::string beside_one(double value);

/// The text, or of a long one its beginning and "...": for values in messages, where what matters is which is meant.
std::string shortened(const std::string& text);

/// The text with every byte that is no printable ASCII as \xNN: for what comes from files.
std::string printable(const std::string& text);

}  // namespace platoon
