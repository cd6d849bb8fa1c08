#include "stochastic_platoon/io/folder_lock.hpp"

#include <gtest/gtest.h>
#include <utime.h>

#include <ctime>
#include <optional>
#include <stdexcept>

#include "../temporary_folder.hpp"

namespace platoon {
namespace {

std::string refusal(const std::string& folder, const std::string& holder) {
  try {
    const FolderLock lock(folder, holder);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(FolderLock, KeepsOthersOutByNameOfItsHolder) {
  const TemporaryFolder folder;
  std::optional<FolderLock> lock(std::in_place, folder.path(), "launch one");
  EXPECT_EQ(refusal(folder.path(), "launch two"), folder.path() + ": is in use by launch one");
  EXPECT_NE(refusal(folder.path(), "launch one"), "") << "not even the same name twice";
  lock.reset();
  EXPECT_EQ(refusal(folder.path(), "launch two"), "");
}

TEST(FolderLock, LeavesAClaimThatOnlyItsHolderCanTake) {
  const TemporaryFolder folder;
  {
    FolderLock lock(folder.path(), "launch one");
    lock.leave_claim();
  }
  EXPECT_EQ(refusal(folder.path(), "launch two"), folder.path() + ": is in use by launch one");
  EXPECT_EQ(refusal(folder.path(), "launch one"), "");
  EXPECT_EQ(refusal(folder.path(), "launch two"), "") << "the holder has released it";
}

TEST(FolderLock, ForgetsAClaimThatNobodyTook) {
  const TemporaryFolder folder;
  {
    FolderLock lock(folder.path(), "launch one");
    lock.leave_claim();
  }
  const std::time_t long_ago = std::time(nullptr) - 31;
  const utimbuf times{long_ago, long_ago};
  ASSERT_EQ(::utime((folder / ".lock").c_str(), &times), 0);
  EXPECT_EQ(refusal(folder.path(), "launch two"), "");
}

TEST(FolderLock, NamesAFolderThatIsNotThere) {
  EXPECT_NE(refusal("/nowhere", "launch one").find("/nowhere/.lock: cannot be opened"), std::string::npos);
}

}  // namespace
}  // namespace platoon
