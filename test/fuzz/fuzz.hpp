#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace platoon::fuzz {

/// A folder of this process, in memory if /dev/shm exists; removed when the process exits normally.
inline const std::string& folder() {
  struct Folder {
    const std::string name = std::string(std::filesystem::exists("/dev/shm") ? "/dev/shm" : "/tmp") +
                             "/stochastic_platoon_fuzz_" + std::to_string(::getpid());
    Folder() { std::filesystem::create_directories(name); }
    ~Folder() { std::filesystem::remove_all(name); }
  };
  static const Folder made;
  return made.name;
}

inline void write(const std::string& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Writes these bytes to a file and returns its name.
inline std::string file_of(const std::uint8_t* data, std::size_t size) {
  const std::string name = folder() + "/input";
  write(name, std::string(reinterpret_cast<const char*>(data), size));
  return name;
}

}  // namespace platoon::fuzz
