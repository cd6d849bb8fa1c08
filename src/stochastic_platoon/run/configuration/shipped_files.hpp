#pragma once

#include <string>

namespace platoon {

/// The folder of this package's models and launch files: in the install space if this code runs there, else the source
/// folder.
std::string package_folder();

/// The path of the shipped file `name` in `folder` ("config") of the package; `name` itself if it names a folder, if
/// the working folder has such a file, or if the package has none.
std::string shipped_file(const std::string& name, const std::string& folder);

/// The paper's example.
std::string paper_model_file();

}  // namespace platoon
