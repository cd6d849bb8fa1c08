#include "stochastic_platoon/run/configuration/shipped_files.hpp"

#include <dlfcn.h>

#include <filesystem>

namespace platoon {

namespace {

// The file that contains this code: a program, or the Python module.
std::filesystem::path own_file() {
  Dl_info found{};
  const bool is_found = ::dladdr(reinterpret_cast<const void*>(&package_folder), &found) != 0;
  const std::filesystem::path file = is_found ? found.dli_fname : "";
  // The name of a program is as its caller wrote it.
  return file.is_absolute() ? file : std::filesystem::read_symlink("/proc/self/exe");
}

}  // namespace

std::string package_folder() {
  for (std::filesystem::path at = own_file().parent_path(); at.has_relative_path(); at = at.parent_path()) {
    const std::filesystem::path installed = at / "share/stochastic_platoon";
    if (std::filesystem::exists(installed / "config/paper.yaml")) return installed.string();
  }
  return PLATOON_SOURCE_DIR;
}

std::string shipped_file(const std::string& name, const std::string& folder) {
  const bool is_bare = !name.empty() && name.find('/') == std::string::npos;
  const std::string shipped = package_folder() + "/" + folder + "/" + name;
  return is_bare && !std::filesystem::exists(name) && std::filesystem::exists(shipped) ? shipped : name;
}

std::string paper_model_file() {
  return package_folder() + "/config/paper.yaml";
}

}  // namespace platoon
