#pragma once

#include <string>

namespace platoon {

/// The text, or the beginning of a long text and "...", to identify a value in a message.
std::string shortened(const std::string& text);

/// The text with every byte outside printable ASCII as `\xNN`, for text read from files.
std::string printable(const std::string& text);

}  // namespace platoon
