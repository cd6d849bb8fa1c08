#include "stochastic_platoon/run/io/read_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {

/// A descriptor, closed at the end.
class Descriptor {
public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

private:
  int number_;
};

std::string kind_of(mode_t mode) {
  return S_ISDIR(mode) ? "a folder" : S_ISFIFO(mode) ? "a FIFO" : S_ISSOCK(mode) ? "a socket" : "a device";
}

}  // namespace

UnreadableFile::UnreadableFile(const std::string& file, std::size_t most, std::error_code code,
                               const std::string& reason)
    : std::system_error(code),
      message_(file + formatted(": must be a regular file of at most %zu MB that can be read (", most / 1000000) +
               reason + ")") {}

std::string read_file(const std::string& file, std::size_t most) {
  const auto fail = [&](int error, const std::string& reason = "") {
    const std::error_code code(error, std::generic_category());
    throw UnreadableFile(file, most, code, reason.empty() ? code.message() : reason);
  };
  if (file.find('\0') != std::string::npos)
    throw UnreadableFile(printable(file), most, std::make_error_code(std::errc::invalid_argument),
                         "a zero byte in its name");
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status {};
  if (opened.number() < 0 || ::fstat(opened.number(), &status) != 0) fail(errno);
  if (!S_ISREG(status.st_mode)) fail(S_ISDIR(status.st_mode) ? EISDIR : EINVAL, kind_of(status.st_mode));
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > most) fail(EFBIG, formatted("%zu bytes", size));
  std::string content;
  content.reserve(size);
  std::vector<char> piece(1 << 16);  // files of the system state no size
  for (;;) {
    check_interruption();
    const ssize_t count = ::read(opened.number(), piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(errno);
    if (count == 0) return content;
    content.append(piece.data(), static_cast<std::size_t>(count));
    if (content.size() > most) fail(EFBIG);
  }
}

bool may_exist(const std::string& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 || (errno != ENOENT && errno != ENOTDIR);
}

}  // namespace platoon
