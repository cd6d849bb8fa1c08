#pragma once

#include <string>

namespace platoon {

/// CRC-32 (ISO 3309; as in zip files and Python's zlib.crc32) of these bytes as eight hexadecimal digits. Detects every
/// change within 32 bits; no protection against deliberate changes.
std::string checksum(const std::string& bytes);

}  // namespace platoon
