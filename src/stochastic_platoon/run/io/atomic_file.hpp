#pragma once

#include <string>

namespace platoon {

/// Puts content into a file so that at any moment, a power failure included, the file is either the old or
/// the new one: written beside it, synced, renamed. Throws std::runtime_error naming the file and the
/// system's reason.
void write_atomically(const std::string& file, const std::string& content);

/// Gives a finished file its final name: synced, renamed, its folder synced. Throws as above.
void sync_and_rename(const std::string& file, const std::string& name);

/// Makes the folder with its parents if need be and tries to write in it. Throws std::runtime_error as above.
void require_writable_folder(const std::string& folder);

/// A limit on the size of files (ulimit -f) then is an error of writing, and no longer ends the program.
void ignore_file_size_signal();

/// "12 MB are free there": of the disk that a file is on.
std::string free_space(const std::string& file);

}  // namespace platoon
