#pragma once

namespace platoon {

/// The version of this package, "major.minor.patch", in its programs and its output files.
extern const char* const kVersion;

/// The revision of the sources that this was built from, as `git describe --always --dirty` names it; "unknown" outside
/// of a repository of its own.
extern const char* const kRevision;

}  // namespace platoon
