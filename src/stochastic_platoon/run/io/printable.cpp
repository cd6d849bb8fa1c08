#include "stochastic_platoon/run/io/printable.hpp"

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

std::string shortened(const std::string& text) {
  constexpr std::size_t kLongest = 80;
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
}

std::string printable(const std::string& text) {
  std::string shown;
  for (const char c : text)
    shown += c >= ' ' && c <= '~' ? std::string(1, c) : formatted("\\x%02x", static_cast<unsigned char>(c));
  return shown;
}

}  // namespace platoon
