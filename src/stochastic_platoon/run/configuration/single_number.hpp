#pragma once

#include <cstdint>
#include <string>

#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// The number in a text that is no part of a document, as an option of a command line. Throws ConfigurationError.
double number_of(const std::string& key, const std::string& text, const Allowed& allowed);
std::int64_t integer_of(const std::string& key, const std::string& text, std::int64_t least, std::int64_t most);

}  // namespace platoon
