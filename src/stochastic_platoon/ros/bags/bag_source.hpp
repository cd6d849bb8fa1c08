#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace platoon {

/// A recording that cannot be read, or not as asked for; names the file and the reason.
class BagError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What a reader accepts of a file.
enum class Accept {
  whole,   ///< closed and undamaged files
  cut,     ///< also a file that was not closed, or ends early: up to there
  damaged  ///< also a damaged file: up to the damage
};

/// The files of a recording and how to read them.
struct BagSource {
  std::vector<std::string> files;
  Accept accept = Accept::whole;
  /// Reads files without checksums, too, as `rosbag record` writes them; then none is verified.
  bool unverified = false;
};

/// File names from a text that separates them by spaces.
std::vector<std::string> bag_files(const std::string& text);

/// A file that ends before it should: its recorder was killed or still runs, or its end is missing.
class BagCut : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file that contradicts the format, itself or its checksums.
class BagDamage : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace platoon
