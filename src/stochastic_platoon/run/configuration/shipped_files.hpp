#pragma once

#include <string>

namespace platoon {

/// The folder of this package's models and launch files: in the install space if this code runs there, else the source
/// folder.
std::string package_folder();

/// `name`, or the shipped file of this name in a folder of the package, as "config", if `name` has no folder and the
/// working folder has no such file.
std::string shipped_file(const std::string& name, const std::string& folder);

/// The paper's example.
std::string paper_model_file();

}  // namespace platoon
