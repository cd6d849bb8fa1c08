#include "stochastic_platoon/run/io/read_file.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace platoon {

std::string read_file(const std::string& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::system_error(errno, std::generic_category(), file);
  // A folder opens like a file, but cannot be read.
  if (std::filesystem::is_directory(file)) throw std::system_error(EISDIR, std::generic_category(), file);
  std::string content{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (stream.bad()) throw std::system_error(errno, std::generic_category(), file);
  return content;
}

}  // namespace platoon
