#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace platoon {

/// printf to a string of any length, in any locale as in that of C.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// The number that the whole text is, in decimal digits with a point, with or without an exponent, in any locale; also
/// "nan" and "inf". None for any other text, as with spaces, a zero byte or 0x10.
std::optional<double> number_in(std::string_view text);

/// The value to six digits, or as "1 - 2.5e-10" if six digits would show 1.
std::string beside_one(double value);

/// The text as one word of a POSIX shell's command line: quoted only where it must be.
std::string shell_word(const std::string& text);

}  // namespace platoon
