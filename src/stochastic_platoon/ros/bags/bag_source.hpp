#pragma once

#include <filesystem>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace platoon {

/// A recording that cannot be read, or not in the requested way. The message names the file and the reason.
class BagError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The name of a file ends with this while it is being written; the recording of an endless run keeps it.
constexpr char kActiveSuffix[] = ".active";

/// The states of a file that a reader accepts.
enum class Accept {
  whole,   ///< closed and undamaged files
  cut,     ///< also a file that was not closed or ends early, read up to its end
  damaged  ///< also a damaged file, read up to the damage
};

/// The files of a recording and how to read them.
struct BagSource {
  std::vector<std::string> files;
  Accept accept = Accept::whole;
  /// Also reads files without checksums, as `rosbag record` writes them. No checksum is then verified.
  bool unverified = false;
};

/// The file names in a text, separated by spaces; or the one file of this name, which may have spaces.
inline std::vector<std::string> bag_files(const std::string& text) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(text, ignored)) return {text};
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// A file that ends early: its recorder was killed or is still running, or its end is missing.
class BagCut : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file that contradicts the format, itself or its checksums.
class BagDamage : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace platoon
