#include "stochastic_platoon/run/io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace platoon {

namespace {

[[noreturn]] void fail(const std::string& file) {
  throw std::system_error(errno, std::generic_category(), file + ": cannot be written");
}

// The folder of a file, by its absolute name if the working folder still exists.
std::string folder_of(const std::string& file) {
  std::error_code ignored;
  const std::filesystem::path absolute = std::filesystem::absolute(file, ignored);
  return (absolute.empty() ? std::filesystem::path("./" + file) : absolute).parent_path().string();
}

// A rename would put a file in the place of a device or of a link to one.
void require_replaceable(const std::string& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return;
  throw std::system_error(S_ISDIR(status.st_mode) ? EISDIR : EEXIST, std::generic_category(),
                          file + ": must be a new file or a regular one");
}

// Throws std::system_error if the file cannot be opened or written; closes it at the end.
class OpenFile {
public:
  OpenFile(const std::string& file, int flags)
      : file_(file), descriptor_(::open(file.c_str(), flags | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) fail(file);
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  void write(const std::string& content) const {
    std::size_t written = 0;
    while (written < content.size()) {
      const ssize_t count = ::write(descriptor_, content.data() + written, content.size() - written);
      if (count < 0 && errno != EINTR) fail(file_);
      if (count > 0) written += static_cast<std::size_t>(count);
    }
  }

  bool sync() const { return ::fsync(descriptor_) == 0; }

private:
  std::string file_;
  int descriptor_;
};

void rename_and_sync(const std::string& file, const std::string& name) {
  if (std::rename(file.c_str(), name.c_str()) != 0) fail(name);
  const OpenFile folder(folder_of(name), O_RDONLY | O_DIRECTORY);
  folder.sync();  // some file systems do not sync folders; the rename is valid regardless
}

}  // namespace

void write_atomically(const std::string& file, const std::string& content, const std::string& previous) {
  require_replaceable(file);
  const std::string beside = file + ".part";
  require_replaceable(beside);
  const OpenFile written(beside, O_WRONLY | O_CREAT | O_TRUNC);
  try {
    written.write(content);
    if (!written.sync()) fail(beside);
    if (!previous.empty() && std::rename(file.c_str(), previous.c_str()) != 0 && errno != ENOENT) fail(previous);
    rename_and_sync(beside, file);
  } catch (...) {
    ::unlink(beside.c_str());
    throw;
  }
}

void sync_and_rename(const std::string& file, const std::string& name) {
  if (!OpenFile(file, O_RDONLY).sync()) fail(file);
  rename_and_sync(file, name);
}

void require_writable_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::system_error(error, folder + ": cannot be made");
  const std::string probe = folder + "/.writable";
  const int descriptor = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(folder);
  ::close(descriptor);
  ::unlink(probe.c_str());
}

void require_possible_folder(const std::string& folder) {
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::absolute(folder, error).lexically_normal();
  std::filesystem::path existing = whole;
  std::filesystem::file_type type = std::filesystem::status(existing, error).type();
  for (; type == std::filesystem::file_type::not_found && existing.has_relative_path();
       type = std::filesystem::status(existing, error).type())
    existing = existing.parent_path();
  if (type == std::filesystem::file_type::not_found) return;  // the working folder is gone: its creation will tell
  if (type == std::filesystem::file_type::directory && ::access(existing.c_str(), W_OK | X_OK) == 0) return;
  if (type == std::filesystem::file_type::directory) error.assign(errno, std::generic_category());
  if (!error) error = std::make_error_code(std::errc::not_a_directory);
  throw std::system_error(
      error, folder + (existing == whole && type == std::filesystem::file_type::directory ? ": cannot be written"
                                                                                          : ": cannot be made"));
}

void ignore_file_size_signal() {
  std::signal(SIGXFSZ, SIG_IGN);
}

std::string free_space(const std::string& file) {
  std::error_code error;
  const std::string folder = folder_of(file);
  const std::uintmax_t bytes = std::filesystem::space(folder, error).available;
  if (error) return "the free space of " + folder + " is unknown";
  return std::to_string(bytes / 1000000) + " MB are free there";
}

}  // namespace platoon
