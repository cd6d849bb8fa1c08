#pragma once

#include <cstddef>
#include <string>
#include <system_error>

namespace platoon {

/// Limits [bytes] of a file: one that a person writes (a model, a sweep, a table of a drive or of losses), and one that
/// this package writes (tables, summaries and checkpoints of runs, of up to 2e7 rows).
constexpr std::size_t kMostGivenBytes = 256'000'000, kMostWrittenBytes = 16'000'000'000;

/// A file that cannot be read. The message names the file, what is allowed, and the reason.
class UnreadableFile : public std::system_error {
public:
  UnreadableFile(const std::string& file, std::size_t most, std::error_code code, const std::string& reason);
  const char* what() const noexcept override { return message_.c_str(); }

private:
  std::string message_;
};

/// The content of a regular file of at most `most` bytes. Any other file is refused before a byte is read, and without
/// waiting: a FIFO for its writer, an endless device. Throws UnreadableFile.
std::string read_file(const std::string& file, std::size_t most);

/// Whether there may be a file or folder of this name: false only if there is certainly none. True also if the system
/// cannot tell, as for a loop of links, a name that is too long, or a folder that is not open to this user; reading or
/// writing it then fails with the reason.
bool may_exist(const std::string& file);

}  // namespace platoon
