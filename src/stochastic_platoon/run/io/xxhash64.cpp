#include "stochastic_platoon/run/io/xxhash64.hpp"

#include <algorithm>
#include <cstring>

namespace platoon {

namespace {

constexpr std::uint64_t kPrime1 = 0x9e3779b185ebca87, kPrime2 = 0xc2b2ae3d27d4eb4f, kPrime3 = 0x165667b19e3779f9,
                        kPrime4 = 0x85ebca77c2b2ae63, kPrime5 = 0x27d4eb2f165667c5;

std::uint64_t rotated(std::uint64_t value, int bits) {
  return (value << bits) | (value >> (64 - bits));
}

template <typename Number>
std::uint64_t read(const unsigned char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

std::uint64_t round(std::uint64_t lane, std::uint64_t input) {
  return rotated(lane + input * kPrime2, 31) * kPrime1;
}

// Processes whole stripes of four words; returns the end of the last.
const unsigned char* take_stripes(std::array<std::uint64_t, 4>& lanes, const unsigned char* bytes,
                                  std::size_t stripes) {
  std::uint64_t a = lanes[0], b = lanes[1], c = lanes[2], d = lanes[3];
  for (; stripes > 0; --stripes, bytes += 32) {
    a = round(a, read<std::uint64_t>(bytes));
    b = round(b, read<std::uint64_t>(bytes + 8));
    c = round(c, read<std::uint64_t>(bytes + 16));
    d = round(d, read<std::uint64_t>(bytes + 24));
  }
  lanes = {a, b, c, d};
  return bytes;
}

}  // namespace

Xxhash64::Xxhash64(std::uint64_t seed)
    : lanes_{seed + kPrime1 + kPrime2, seed + kPrime2, seed, seed - kPrime1}, seed_(seed) {}

void Xxhash64::add(const void* bytes, std::size_t size) {
  const auto* at = static_cast<const unsigned char*>(bytes);
  total_ += size;
  if (rest_size_ > 0) {
    const std::size_t taken = std::min(size, kStripe - rest_size_);
    std::memcpy(rest_.data() + rest_size_, at, taken);
    rest_size_ += taken;
    at += taken;
    size -= taken;
    if (rest_size_ < kStripe) return;
    take_stripes(lanes_, rest_.data(), 1);
  }
  at = take_stripes(lanes_, at, size / kStripe);
  rest_size_ = size % kStripe;
  if (rest_size_ > 0) std::memcpy(rest_.data(), at, rest_size_);
}

std::uint64_t Xxhash64::value() const {
  std::uint64_t hash = seed_ + kPrime5;
  if (total_ >= kStripe) {
    hash = rotated(lanes_[0], 1) + rotated(lanes_[1], 7) + rotated(lanes_[2], 12) + rotated(lanes_[3], 18);
    for (const std::uint64_t lane : lanes_) hash = (hash ^ round(0, lane)) * kPrime1 + kPrime4;
  }
  hash += total_;
  const unsigned char* at = rest_.data();
  std::size_t left = rest_size_;
  for (; left >= 8; left -= 8, at += 8)
    hash = rotated(hash ^ round(0, read<std::uint64_t>(at)), 27) * kPrime1 + kPrime4;
  for (; left >= 4; left -= 4, at += 4)
    hash = rotated(hash ^ (read<std::uint32_t>(at) * kPrime1), 23) * kPrime2 + kPrime3;
  for (; left > 0; --left, ++at) hash = rotated(hash ^ (*at * kPrime5), 11) * kPrime1;
  hash = (hash ^ (hash >> 33)) * kPrime2;
  hash = (hash ^ (hash >> 29)) * kPrime3;
  return hash ^ (hash >> 32);
}

std::uint64_t xxhash64(const std::string& bytes, std::uint64_t seed) {
  Xxhash64 hash(seed);
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

}  // namespace platoon
