#pragma once

#include <string>

namespace platoon {

/// CRC-32 (ISO 3309; that of zip files and of Python's zlib.crc32) of these bytes as eight hexadecimal digits. Any
/// change within 32 bits is recognized; it is no protection against intent.
std::string checksum(const std::string& bytes);

}  // namespace platoon
