#include "stochastic_platoon/run/configuration/version.hpp"

namespace platoon {

const char* const kVersion = PLATOON_VERSION;  // set by CMakeLists.txt

}  // namespace platoon
