#include "stochastic_platoon/math/numerics/text.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace platoon {

std::string formatted(const char* format, ...) {
  std::va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  std::vsnprintf(text.data(), text.size(), format, again);
  va_end(again);
  va_end(arguments);
  text.pop_back();
  return text;
}

std::string beside_one(double value) {
  const double difference = value - 1.0;
  if (!(std::abs(difference) < 1e-5) || difference == 0.0) return formatted("%.6g", value);
  return formatted("1 %c %.3g", difference > 0.0 ? '+' : '-', std::abs(difference));
}

}  // namespace platoon
