#pragma once

#include <cstdint>
#include <string>

namespace platoon {

/// 64 bit FNV-1a digest (G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, The FNV non-cryptographic hash algorithm). Of
/// two texts that differ in one byte the digests always differ; it is no protection against intent.
std::uint64_t digest(const std::string& bytes);

}  // namespace platoon
