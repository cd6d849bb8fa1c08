#include "stochastic_platoon/run/configuration/shipped_files.hpp"

#include <dlfcn.h>

#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <set>

#include "stochastic_platoon/run/io/read_file.hpp"

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

bool is_bare(const std::string& name) {
  return !name.empty() && name.find('/') == std::string::npos;
}

bool is_regular(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored);
}

}  // namespace

std::string package_folder() {
  for (std::filesystem::path at = own_file().parent_path(); at.has_relative_path(); at = at.parent_path()) {
    const std::filesystem::path installed = at / "share/stochastic_platoon";
    if (is_regular(installed / "config/paper.yaml")) return installed.string();
  }
  return PLATOON_SOURCE_DIR;
}

std::string shipped_file(const std::string& name, const std::string& folder, const std::string& beside) {
  if (name.find('\0') != std::string::npos) return name;
  const std::string own = (std::filesystem::path(beside) / name).string();
  const std::filesystem::path shipped = std::filesystem::path(package_folder()) / folder / name;
  return is_bare(name) && !may_exist(own) && is_regular(shipped) ? shipped.string() : own;
}

std::string shipped_names(const std::string& folder) {
  std::set<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(package_folder() + "/" + folder, ignored)) {
    const std::string extension = entry.path().extension();
    if (extension == ".yaml" || extension == ".csv") names.insert(entry.path().filename());
  }
  return boost::algorithm::join(names, ", ");
}

std::string paper_model_file() {
  return package_folder() + "/config/paper.yaml";
}

}  // namespace platoon
