#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace platoon {

/// XXH64 (Y. Collet, xxHash fast digest algorithm, version 0.1.1): 64 bits over bytes in pieces of any size. About as
/// fast as memory is read; no protection against deliberate changes.
class Xxhash64 {
public:
  explicit Xxhash64(std::uint64_t seed = 0);

  void add(const void* bytes, std::size_t size);

  /// The hash of all bytes added.
  std::uint64_t value() const;

private:
  static constexpr std::size_t kStripe = 32;

  std::array<std::uint64_t, 4> lanes_;
  std::uint64_t seed_;
  std::uint64_t total_ = 0;
  std::array<unsigned char, kStripe> rest_ = {};  ///< bytes of an incomplete stripe
  std::size_t rest_size_ = 0;
};

std::uint64_t xxhash64(const std::string& bytes, std::uint64_t seed = 0);

}  // namespace platoon
