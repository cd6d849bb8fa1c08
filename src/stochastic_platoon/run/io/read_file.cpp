#include "stochastic_platoon/run/io/read_file.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

namespace platoon {

std::string read_file(const std::string& file, std::size_t most) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::system_error(errno, std::generic_category(), file);
  // A folder opens like a file, but cannot be read.
  if (std::filesystem::is_directory(file)) throw std::system_error(EISDIR, std::generic_category(), file);
  // In pieces: merge reads thousands of files, and stream iterators read one byte at a time.
  std::string content;
  std::vector<char> piece(1 << 16);
  while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0) {
    content.append(piece.data(), static_cast<std::size_t>(stream.gcount()));
    if (content.size() > most) throw std::system_error(EFBIG, std::generic_category(), file);
  }
  if (stream.bad()) throw std::system_error(errno, std::generic_category(), file);
  return content;
}

}  // namespace platoon
