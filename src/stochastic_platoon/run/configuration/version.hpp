#pragma once

namespace platoon {

/// The version of this package, "major.minor.patch": of its programs, and of what they write.
extern const char* const kVersion;

}  // namespace platoon
