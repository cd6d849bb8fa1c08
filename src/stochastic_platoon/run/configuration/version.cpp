#include "stochastic_platoon/run/configuration/version.hpp"

#include "platoon_revision.hpp"

namespace platoon {

const char* const kVersion = PLATOON_VERSION;    // set by CMakeLists.txt
const char* const kRevision = PLATOON_REVISION;  // set by revision.cmake

bool is_readable(const std::string& version) {
  return version == kVersion || version == kFirstReadableVersion;
}

}  // namespace platoon
