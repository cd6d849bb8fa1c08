#include "stochastic_platoon/run/io/checksum.hpp"

#include <boost/crc.hpp>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

std::string checksum(const std::string& bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return formatted("%08x", static_cast<unsigned>(crc.checksum()));
}

}  // namespace platoon
