#include "stochastic_platoon/run/io/digest.hpp"

namespace platoon {

std::uint64_t digest(const std::string& bytes) {
  std::uint64_t value = 0xcbf29ce484222325;
  for (const char c : bytes) value = (value ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return value;
}

}  // namespace platoon
