#pragma once

#define XXH_INLINE_ALL  // needs no shared library
#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace platoon {

/// XXH64 (Y. Collet, xxHash fast digest algorithm, version 0.1.1) of libxxhash: 64 bits over bytes in pieces of any
/// size. About as fast as memory is read; no protection against deliberate changes.
class Xxhash64 {
public:
  explicit Xxhash64(std::uint64_t seed = 0) { XXH64_reset(&state_, seed); }

  void add(const void* bytes, std::size_t size) { XXH64_update(&state_, bytes, size); }

  /// The hash of all bytes added.
  std::uint64_t value() const { return XXH64_digest(&state_); }

private:
  XXH64_state_t state_;
};

inline std::uint64_t xxhash64(const std::string& bytes, std::uint64_t seed = 0) {
  return XXH64(bytes.data(), bytes.size(), seed);
}

}  // namespace platoon
