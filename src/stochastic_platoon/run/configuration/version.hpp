#pragma once

namespace platoon {

/// The version of this package, "major.minor.patch", in its programs and its output files.
extern const char* const kVersion;

}  // namespace platoon
