#include "stochastic_platoon/run/io/read_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "unit/messages.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

class ReadFile : public testing::Test {
protected:
  std::string error_of(const std::string& file, std::size_t most = 256000000) {
    return message_of<UnreadableFile>([&] { read_file(file, most); });
  }

  void expect_refused(const std::string& file, const std::string& reason) {
    EXPECT_EQ(error_of(file), file + ": must be a regular file of at most 256 MB that can be read (" + reason + ")");
  }

  TemporaryFolder folder_;
};

TEST_F(ReadFile, ReturnsEveryByteOfARegularFile) {
  std::string content;
  for (int j = 0; j < 300000; ++j) content.push_back(static_cast<char>(j % 256));
  EXPECT_EQ(read_file(folder_.file("bytes", content), kMostGivenBytes), content);
  EXPECT_EQ(read_file(folder_.file("empty", ""), kMostGivenBytes), "");
  EXPECT_FALSE(read_file("/proc/self/status", kMostGivenBytes).empty()) << "states a size of 0";
}

// A FIFO without a writer would block, and /dev/zero never ends.
TEST_F(ReadFile, RefusesEverythingElseAtOnce) {
  const std::string fifo = folder_ / "fifo", loop = folder_ / "loop";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  std::filesystem::create_symlink("loop", loop);
  expect_refused(fifo, "a FIFO");
  expect_refused("/dev/zero", "a device");
  expect_refused(folder_.path(), "a folder");
  expect_refused(loop, "Too many levels of symbolic links");
  expect_refused(folder_ / std::string(300, 'a'), "File name too long");
  expect_refused(folder_ / "none", "No such file or directory");
  EXPECT_TRUE(contains(error_of(folder_.file("whole", "1") + std::string("\0.csv", 5)),
                       "whole\\x00.csv: must be a regular file of at most 256 MB that can be read (a zero byte"));
}

TEST_F(ReadFile, RefusesALargerFileBeforeItReads) {
  const std::string sparse = folder_.file("sparse", "");
  std::filesystem::resize_file(sparse, std::uintmax_t{1} << 40);
  expect_refused(sparse, "1099511627776 bytes");
  EXPECT_EQ(error_of(folder_.file("ten", "0123456789"), 10), "");
  EXPECT_TRUE(contains(error_of(folder_ / "ten", 9), "(10 bytes)"));
  EXPECT_TRUE(contains(error_of("/proc/self/status", 9), "(File too large)")) << "states a size of 0";
}

TEST_F(ReadFile, MayExistUnlessTheNameIsFree) {
  std::filesystem::create_symlink("loop", folder_ / "loop");
  EXPECT_TRUE(may_exist(folder_.path()));
  EXPECT_TRUE(may_exist(folder_ / "loop"));
  EXPECT_TRUE(may_exist(folder_ / std::string(300, 'a')));
  EXPECT_FALSE(may_exist(folder_ / "none"));
  EXPECT_FALSE(may_exist(folder_.file("file", "") + "/none"));
}

}  // namespace
}  // namespace platoon
