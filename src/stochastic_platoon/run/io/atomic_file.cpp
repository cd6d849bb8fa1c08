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

void write_all(int descriptor, const std::string& content, const std::string& file) {
  std::size_t written = 0;
  while (written < content.size()) {
    const ssize_t count = ::write(descriptor, content.data() + written, content.size() - written);
    if (count < 0 && errno != EINTR) fail(file);
    if (count > 0) written += static_cast<std::size_t>(count);
  }
}

void sync_folder_of(const std::string& file) {
  const std::string folder = std::filesystem::absolute(file).parent_path().string();
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) fail(folder);
  ::fsync(descriptor);  // some file systems do not sync folders; the rename is valid regardless
  ::close(descriptor);
}

}  // namespace

void write_atomically(const std::string& file, const std::string& content) {
  const std::string beside = file + ".part";
  const int descriptor = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(beside);
  try {
    write_all(descriptor, content, beside);
    if (::fsync(descriptor) != 0) fail(beside);
  } catch (...) {
    ::close(descriptor);
    ::unlink(beside.c_str());
    throw;
  }
  if (::close(descriptor) != 0) fail(beside);
  if (std::rename(beside.c_str(), file.c_str()) != 0) {
    const int reason = errno;
    ::unlink(beside.c_str());
    errno = reason;
    fail(file);
  }
  sync_folder_of(file);
}

void sync_and_rename(const std::string& file, const std::string& name) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(file);
  const bool synced = ::fsync(descriptor) == 0;
  ::close(descriptor);
  if (!synced) fail(file);
  if (std::rename(file.c_str(), name.c_str()) != 0) fail(name);
  sync_folder_of(name);
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
  if (error) return folder + " cannot be looked at";
  return std::to_string(bytes / 1000000) + " MB are free there";
}

}  // namespace platoon
