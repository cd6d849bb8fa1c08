#pragma once

#include <string>

namespace platoon {

/// The version of this package, "major.minor.patch", in its programs and its output files.
extern const char* const kVersion;

/// The first version whose recordings this one reads.
constexpr const char* kFirstReadableVersion = "0.2.0";

/// Whether this version reads recordings of a version: its own, and kFirstReadableVersion.
bool is_readable(const std::string& version);

/// The revision of the sources that this was built from, as `git describe --always --dirty` names it; "unknown" outside
/// of a repository of its own.
extern const char* const kRevision;

}  // namespace platoon
