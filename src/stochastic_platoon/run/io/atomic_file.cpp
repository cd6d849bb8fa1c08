#include "stochastic_platoon/run/io/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace platoon {

namespace {

[[noreturn]] void fail(const std::string& file) {
  throw std::runtime_error(file + ": cannot be written: " + std::generic_category().message(errno));
}

// Throws std::runtime_error if the file cannot be opened or written; closes it at the end.
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
  const OpenFile folder(std::filesystem::absolute(name).parent_path().string(), O_RDONLY | O_DIRECTORY);
  folder.sync();  // some file systems do not sync folders; the rename is valid regardless
}

}  // namespace

void write_atomically(const std::string& file, const std::string& content) {
  const std::string beside = file + ".part";
  const OpenFile written(beside, O_WRONLY | O_CREAT | O_TRUNC);
  try {
    written.write(content);
    if (!written.sync()) fail(beside);
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
  if (error) throw std::runtime_error(folder + ": cannot be made: " + error.message());
  const std::string probe = folder + "/.writable";
  const int descriptor = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(folder);
  ::close(descriptor);
  ::unlink(probe.c_str());
}

void ignore_file_size_signal() {
  std::signal(SIGXFSZ, SIG_IGN);
}

std::string free_space(const std::string& file) {
  std::error_code error;
  const std::string folder = std::filesystem::absolute(file).parent_path().string();
  const std::uintmax_t bytes = std::filesystem::space(folder, error).available;
  if (error) return "the free space of " + folder + " is unknown";
  return std::to_string(bytes / 1000000) + " MB are free there";
}

}  // namespace platoon
