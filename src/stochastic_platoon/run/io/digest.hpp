#pragma once

#include <cstdint>
#include <string>

namespace platoon {

/// 64 bit FNV-1a digest (G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, The FNV non-cryptographic hash algorithm). Two
/// texts that differ in one byte always have different digests; no protection against deliberate changes.
std::uint64_t digest(const std::string& bytes);

}  // namespace platoon
