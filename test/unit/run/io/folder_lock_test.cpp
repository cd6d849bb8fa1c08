#include "stochastic_platoon/run/io/folder_lock.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utime.h>

#include <csignal>
#include <ctime>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "stochastic_platoon/run/io/process_identity.hpp"
#include "unit/temporary_folder.hpp"

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

std::string begin_of(const std::string& text, const std::string& whole) {
  return whole.substr(0, text.size());
}

std::string content_of(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void set_time(const std::string& file, std::time_t time) {
  const utimbuf times{time, time};
  ASSERT_EQ(::utime(file.c_str(), &times), 0);
}

// A process that runs until end() kills it.
class Child {
public:
  Child() : number_(::fork()) {
    if (number_ == 0) {
      ::pause();
      ::_exit(0);
    }
  }
  ~Child() { end(); }
  void end() {
    if (number_ == 0) return;
    ::kill(number_, SIGKILL);
    ::waitpid(number_, nullptr, 0);
    number_ = 0;
  }
  pid_t number() const { return number_; }

private:
  pid_t number_;
};

// Leaves the lock of a process that was killed while it held it.
void take_and_be_killed(const std::string& folder, const std::string& holder, pid_t guardian) {
  const pid_t process = ::fork();
  if (process == 0) {
    const FolderLock lock(folder, holder, guardian);
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(process, nullptr, 0);
}

TEST(FolderLock, KeepsOthersOutByNameOfItsHolder) {
  const TemporaryFolder folder;
  std::optional<FolderLock> lock(std::in_place, folder.path(), "launch one");
  EXPECT_EQ(
      refusal(folder.path(), "launch two"),
      folder.path() + ": is in use by launch one; it is free when process " + std::to_string(::getpid()) + " ends");
  EXPECT_NE(refusal(folder.path(), "launch one"), "") << "not even the same name twice";
  lock.reset();
  EXPECT_EQ(refusal(folder.path(), "launch two"), "");
}

TEST(FolderLock, OfAProcessThatWasKilledIsFreeAtOnce) {
  const TemporaryFolder folder;
  take_and_be_killed(folder.path(), "launch one", 0);
  EXPECT_EQ(refusal(folder.path(), "launch two"), "");
}

TEST(FolderLock, OfAProcessThatIsStartedAgainIsItsGuardians) {
  const TemporaryFolder folder;
  Child guardian;
  take_and_be_killed(folder.path(), "launch one", guardian.number());
  EXPECT_EQ(refusal(folder.path(), "launch two"),
            folder.path() + ": is in use by launch one, which starts it again; it is free when process " +
                std::to_string(guardian.number()) + " ends");
  guardian.end();
  EXPECT_EQ(refusal(folder.path(), "launch two"), "");
}

TEST(FolderLock, LeavesAClaimThatOnlyItsHolderCanTake) {
  const TemporaryFolder folder;
  {
    FolderLock lock(folder.path(), "launch one");
    lock.leave_claim(::getpid());
  }
  const std::string expected = folder.path() + ": is in use by launch one; it is free in ";
  const std::string said = refusal(folder.path(), "launch two");
  EXPECT_EQ(begin_of(expected, said), expected);
  EXPECT_NE(said.find("s unless that takes it, or when process " + std::to_string(::getpid()) + " ends"),
            std::string::npos)
      << said;
  EXPECT_EQ(refusal(folder.path(), "launch one"), "");
  EXPECT_EQ(refusal(folder.path(), "launch two"), "") << "the holder has released it";
}

TEST(FolderLock, ForgetsAClaimWhoseGuardianHasEnded) {
  const TemporaryFolder folder;
  Child guardian;
  {
    FolderLock lock(folder.path(), "launch one");
    lock.leave_claim(guardian.number());
  }
  EXPECT_NE(refusal(folder.path(), "launch two"), "");
  guardian.end();
  EXPECT_EQ(refusal(folder.path(), "launch two"), "");
}

TEST(FolderLock, ForgetsAClaimThatNobodyTookWhateverTheClockShows) {
  const TemporaryFolder folder;
  {
    FolderLock lock(folder.path(), "launch one");
    lock.leave_claim(::getpid());
  }
  // The end of the claim decides; the time of the file has no effect.
  const std::string file = folder / ".lock";
  for (const std::time_t other : {-3600, 3600}) {
    set_time(file, std::time(nullptr) + other);
    EXPECT_NE(refusal(folder.path(), "launch two"), "");
  }
  std::string content = content_of(file);
  content.resize(content.rfind('\n', content.size() - 2) + 1);
  std::ofstream(file) << content << seconds_since_boot() - 0.1 << "\n";
  set_time(file, std::time(nullptr) + 3600);
  EXPECT_EQ(refusal(folder.path(), "launch two"), "");
}

TEST(FolderLock, KnowsAProcessByItsStart) {
  const TemporaryFolder folder;
  Child guardian;
  take_and_be_killed(folder.path(), "launch one", guardian.number());
  std::string content = content_of(folder / ".lock");
  const std::string start = std::to_string(process_identity(guardian.number())->start);
  content.replace(content.rfind(start), start.size(), "17");  // another process had this number
  std::ofstream(folder / ".lock") << content;
  EXPECT_EQ(refusal(folder.path(), "launch two"), "");
}

TEST(FolderLock, OfAnotherMachineKeepsOthersOutForAWhileByTheFilesTime) {
  const TemporaryFolder folder;
  const std::string file = folder / ".lock";
  for (const std::string content : {"launch one\n7 8 another-boot,pid:[1]\n-\n", "launch one"}) {
    std::ofstream(file) << content;
    const std::string said = refusal(folder.path(), "launch two");
    EXPECT_NE(said.find("is in use by launch one on another machine; it is free in "), std::string::npos) << said;
    std::ofstream(file) << content;
    set_time(file, std::time(nullptr) - 31);
    EXPECT_EQ(refusal(folder.path(), "launch two"), "");
    std::ofstream(file) << content;
    set_time(file, std::time(nullptr) + 3600);
    EXPECT_EQ(refusal(folder.path(), "launch two"), "") << "a time to come";
  }
}

TEST(FolderLock, NamesAFolderThatIsNotThere) {
  EXPECT_NE(refusal("/nowhere", "launch one").find("/nowhere/.lock: cannot be opened"), std::string::npos);
}

}  // namespace
}  // namespace platoon
