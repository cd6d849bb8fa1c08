#include "stochastic_platoon/run/io/folder_lock.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utime.h>

#include <csignal>
#include <ctime>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "stochastic_platoon/run/io/process_identity.hpp"
#include "unit/messages.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

// Locks the folder and releases it; the error if it is in use, or an empty string.
std::string rejection(const TemporaryFolder& folder, const std::string& holder) {
  return message_of<std::runtime_error>([&] { const FolderLock lock(folder.path(), holder); });
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

// Leaves the lock of a process that was killed while it held it. 0: without a guardian.
void take_and_be_killed(const TemporaryFolder& folder, pid_t guardian) {
  const pid_t process = ::fork();
  if (process == 0) {
    const FolderLock lock(folder.path(), "launch one", guardian);
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(process, nullptr, 0);
}

// Leaves a claim of "launch one".
void take_and_claim(const TemporaryFolder& folder, pid_t guardian) {
  FolderLock lock(folder.path(), "launch one");
  lock.leave_claim(guardian);
}

TEST(FolderLock, ExcludesOthersAndNamesItsHolder) {
  const TemporaryFolder folder;
  std::optional<FolderLock> lock(std::in_place, folder.path(), "launch one");
  EXPECT_EQ(rejection(folder, "launch two"), folder.path() + ": is in use by launch one; it is free when process " +
                                                 std::to_string(::getpid()) + " ends");
  EXPECT_NE(rejection(folder, "launch one"), "") << "not even the same name twice";
  lock.reset();
  EXPECT_EQ(rejection(folder, "launch two"), "");
}

TEST(FolderLock, IsFreeOnceItsProcessIsKilled) {
  const TemporaryFolder folder;
  take_and_be_killed(folder, 0);
  EXPECT_EQ(rejection(folder, "launch two"), "");
}

TEST(FolderLock, IsHeldForAKilledProcessWhileItsGuardianLives) {
  const TemporaryFolder folder;
  Child guardian;
  take_and_be_killed(folder, guardian.number());
  EXPECT_EQ(rejection(folder, "launch two"),
            folder.path() + ": is in use by launch one, which starts it again; it is free when process " +
                std::to_string(guardian.number()) + " ends");
  guardian.end();
  EXPECT_EQ(rejection(folder, "launch two"), "");
}

TEST(FolderLock, LeavesAClaimThatOnlyItsHolderCanTake) {
  const TemporaryFolder folder;
  take_and_claim(folder, ::getpid());
  const std::string error = rejection(folder, "launch two");
  EXPECT_TRUE(begins_with(error, folder.path() + ": is in use by launch one; it is free in "));
  EXPECT_TRUE(contains(error, "s unless that takes it, or when process " + std::to_string(::getpid()) + " ends"));
  EXPECT_EQ(rejection(folder, "launch one"), "");
  EXPECT_EQ(rejection(folder, "launch two"), "") << "the holder has released it";
}

TEST(FolderLock, IgnoresAClaimWhoseGuardianHasEnded) {
  const TemporaryFolder folder;
  Child guardian;
  take_and_claim(folder, guardian.number());
  EXPECT_NE(rejection(folder, "launch two"), "");
  guardian.end();
  EXPECT_EQ(rejection(folder, "launch two"), "");
}

TEST(FolderLock, IgnoresAnExpiredClaimWhateverTheClockShows) {
  const TemporaryFolder folder;
  take_and_claim(folder, ::getpid());
  // The end of the claim decides; the time of the file has no effect.
  const std::string file = folder / ".lock";
  for (const std::time_t other : {-3600, 3600}) {
    set_time(file, std::time(nullptr) + other);
    EXPECT_NE(rejection(folder, "launch two"), "");
  }
  std::string content = content_of(file);
  content.resize(content.rfind('\n', content.size() - 2) + 1);
  std::ofstream(file) << content << seconds_since_boot() - 0.1 << "\n";
  set_time(file, std::time(nullptr) + 3600);
  EXPECT_EQ(rejection(folder, "launch two"), "");
}

TEST(FolderLock, IdentifiesAProcessByItsStart) {
  const TemporaryFolder folder;
  Child guardian;
  take_and_be_killed(folder, guardian.number());
  std::string content = content_of(folder / ".lock");
  const std::string start = std::to_string(process_identity(guardian.number())->start);
  content.replace(content.rfind(start), start.size(), "17");  // another process had this number
  std::ofstream(folder / ".lock") << content;
  EXPECT_EQ(rejection(folder, "launch two"), "");
}

TEST(FolderLock, OfAnotherMachineExcludesOthersForAWhileByTheTimeOfTheFile) {
  const TemporaryFolder folder;
  const std::string file = folder / ".lock";
  const std::string content = "launch one\n7 8 another-boot,pid:[1]\n-\n";
  std::ofstream(file) << content;
  const std::string error = rejection(folder, "launch two");
  EXPECT_TRUE(contains(error, "is in use by launch one on another machine; it is free in "));
  std::ofstream(file) << content;
  set_time(file, std::time(nullptr) - 31);
  EXPECT_EQ(rejection(folder, "launch two"), "");
  std::ofstream(file) << content;
  set_time(file, std::time(nullptr) + 3600);
  EXPECT_EQ(rejection(folder, "launch two"), "") << "a time to come";
}

// Lost power leaves a part of the text, or zeros in its place.
TEST(FolderLock, IgnoresAnEntryThatIsNotWhole) {
  const TemporaryFolder folder;
  const std::string whole = "launch one\n7 8 another-boot,pid:[1]\n-\n";
  for (const std::string& content :
       {std::string("launch one"), whole.substr(0, whole.size() - 1), std::string(whole.size(), '\0')}) {
    std::ofstream(folder / ".lock") << content;
    EXPECT_EQ(rejection(folder, "launch two"), "");
  }
}

TEST(FolderLock, NamesAMissingFolder) {
  EXPECT_TRUE(contains(message_of<std::runtime_error>([] { FolderLock("/nowhere", "launch one"); }),
                       "/nowhere/.lock: cannot be opened"));
}

}  // namespace
}  // namespace platoon
