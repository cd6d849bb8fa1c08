#include "stochastic_platoon/math/numerics/text.hpp"

#include <locale.h>

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace platoon {

namespace {

// The locale of C, whatever a program that loads this library has set: numbers have a point.
locale_t classic() {
  static const locale_t locale = ::newlocale(LC_ALL_MASK, "C", nullptr);
  return locale;
}

}  // namespace

std::string formatted(const char* format, ...) {
  const locale_t before = ::uselocale(classic());
  std::va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  std::vsnprintf(text.data(), text.size(), format, again);
  va_end(again);
  va_end(arguments);
  ::uselocale(before);
  text.pop_back();
  return text;
}

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::size_t digits_at(std::string_view text, std::size_t begin) {
  std::size_t end = begin;
  while (end < text.size() && is_digit(text[end])) ++end;
  return end - begin;
}

// Whether the text is digits with an optional point and an optional exponent.
bool is_decimal(std::string_view text) {
  std::size_t at = digits_at(text, 0), digits = at;
  if (at < text.size() && text[at] == '.') {
    const std::size_t behind = digits_at(text, at + 1);
    digits += behind;
    at += 1 + behind;
  }
  if (digits == 0) return false;
  if (at == text.size()) return true;
  if (text[at] != 'e' && text[at] != 'E') return false;
  ++at;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) ++at;
  const std::size_t exponent = digits_at(text, at);
  return exponent > 0 && at + exponent == text.size();
}

}  // namespace

std::optional<double> number_in(std::string_view text) {
  const bool has_sign = !text.empty() && (text.front() == '+' || text.front() == '-');
  const std::string_view unsigned_text = text.substr(has_sign ? 1 : 0);
  if (unsigned_text != "nan" && unsigned_text != "inf" && !is_decimal(unsigned_text)) return std::nullopt;
  char buffer[40] = {};  // enough for 17 digits; strtod needs a zero at the end
  if (text.size() >= sizeof buffer) return ::strtod_l(std::string(text).c_str(), nullptr, classic());
  text.copy(buffer, text.size());
  return ::strtod_l(buffer, nullptr, classic());
}

std::string beside_one(double value) {
  const double difference = value - 1.0;
  if (!(std::abs(difference) < 1e-5) || difference == 0.0) return formatted("%.6g", value);
  return formatted("1 %c %.3g", difference > 0.0 ? '+' : '-', std::abs(difference));
}

std::string shell_word(const std::string& text) {
  constexpr char kPlain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789@%+=:,./_-";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

}  // namespace platoon
