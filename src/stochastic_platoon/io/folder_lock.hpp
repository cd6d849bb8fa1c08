#pragma once

#include <string>

namespace platoon {

/// Keeps a folder for one holder: flock(2) on the file `.lock` in it, which names the holder. It is released when
/// this object or its process ends, however that ends.
///
/// A holder may claim the folder before the process that will hold it is there (the launch that checks the folder,
/// for its monitor): a claim keeps others out for kClaimSeconds.
class FolderLock {
public:
  static constexpr double kClaimSeconds = 30.0;

  /// Takes the folder, which must exist. Throws std::runtime_error naming the holder when it is another's.
  FolderLock(const std::string& folder, const std::string& holder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Ends it, but keeps others out for a while: whoever comes with this holder's name takes it.
  void leave_claim() { claim_ = true; }

private:
  std::string file_;
  int descriptor_;
  bool claim_ = false;
};

}  // namespace platoon
