#pragma once

#include <string>

namespace platoon {

/// Writes content to a file atomically: at any moment, even after a power failure, the file has either the old or the
/// new content. Writes a file beside it, syncs it and renames it. Throws std::system_error with the file and the
/// system's reason, also if the file exists and is no regular one: a rename would replace a device. `previous`: the
/// name under which the old content stays, given as soon as the new content is safe.
void write_atomically(const std::string& file, const std::string& content, const std::string& previous = "");

/// Gives a finished file its final name: syncs it, renames it, syncs its folder. Throws as above.
void sync_and_rename(const std::string& file, const std::string& name);

/// Creates the folder and its parents if necessary and tests that it is writable. Throws std::system_error as above.
void require_writable_folder(const std::string& folder);

/// The same as far as it can be known without creating anything.
void require_possible_folder(const std::string& folder);

/// Makes a file size limit (ulimit -f) a write error instead of a signal that ends the program.
void ignore_file_size_signal();

/// "12 MB are free there": free space on the disk of a file.
std::string free_space(const std::string& file);

}  // namespace platoon
