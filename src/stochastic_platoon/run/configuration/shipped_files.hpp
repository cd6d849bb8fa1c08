#pragma once

#include <string>

namespace platoon {

/// The folder of this package's models and launch files: in the install space if this code runs there, else the source
/// folder.
std::string package_folder();

/// The file that a person means by `name`, relative to the folder `beside` (empty: the working folder). A name without
/// a folder means the shipped file in `folder` ("config") of the package if there is one, and none of this name beside.
std::string shipped_file(const std::string& name, const std::string& folder, const std::string& beside = "");

/// The names of the shipped models ("config") or drives ("config/leaders"): "acc.yaml, cacc.yaml".
std::string shipped_names(const std::string& folder);

/// The paper's example.
std::string paper_model_file();

}  // namespace platoon
