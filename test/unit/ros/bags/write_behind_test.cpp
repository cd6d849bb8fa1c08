#include "stochastic_platoon/ros/bags/write_behind.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "unit/messages.hpp"

namespace platoon {
namespace {

constexpr std::size_t kMegabyte = 1 << 20;

class WriteBehindTest : public testing::Test {
protected:
  void SetUp() override {
    char pattern[] = "/tmp/write_behind_XXXXXX";
    descriptor_ = ::mkstemp(pattern);
    ASSERT_GE(descriptor_, 0);
    file_ = pattern;
  }
  void TearDown() override {
    ::close(descriptor_);
    ::unlink(file_.c_str());
  }

  void write(std::size_t megabytes, WriteBehind* behind) {
    for (std::size_t m = 0; m < megabytes; ++m) {
      const std::vector<char> piece(kMegabyte, static_cast<char>(m + 1));
      ASSERT_EQ(::write(descriptor_, piece.data(), piece.size()), static_cast<ssize_t>(piece.size()));
      if (behind != nullptr) behind->advance((m + 1) * kMegabyte);
    }
  }

  std::size_t resident_megabytes(std::size_t megabytes) const {
    void* const map = ::mmap(nullptr, megabytes * kMegabyte, PROT_READ, MAP_SHARED, descriptor_, 0);
    std::vector<unsigned char> pages(megabytes * kMegabyte / 4096);
    EXPECT_EQ(::mincore(map, megabytes * kMegabyte, pages.data()), 0);
    ::munmap(map, megabytes * kMegabyte);
    std::size_t resident = 0;
    for (const unsigned char page : pages) resident += page & 1;
    return resident * 4096 / kMegabyte;
  }

  int descriptor_ = -1;
  std::string file_;
};

TEST_F(WriteBehindTest, ReleasesThePageCache) {
  struct statfs system;
  ASSERT_EQ(::fstatfs(descriptor_, &system), 0);
  if (system.f_type == TMPFS_MAGIC) GTEST_SKIP() << "/tmp is in memory";
  WriteBehind behind(file_);
  write(128, &behind);
  EXPECT_LT(resident_megabytes(128), 40u);
}

TEST_F(WriteBehindTest, ReleasesTheBlocksReservedAhead) {
  WriteBehind behind(file_);
  write(32, &behind);
  behind.finish();
  struct stat status;
  ASSERT_EQ(::fstat(descriptor_, &status), 0);
  EXPECT_EQ(static_cast<std::size_t>(status.st_size), 32 * kMegabyte);
  EXPECT_LT(static_cast<std::size_t>(status.st_blocks) * 512, 34 * kMegabyte);
}

TEST_F(WriteBehindTest, KeepsTheContentOfTheFile) {
  WriteBehind behind(file_);
  write(70, &behind);
  const std::vector<char> late(4, 'x');
  ASSERT_EQ(::pwrite(descriptor_, late.data(), late.size(), 64 * kMegabyte),
            4);  // as rosbag does in its latest chunk
  behind.advance(71 * kMegabyte);
  std::vector<char> read(70 * kMegabyte);
  ASSERT_EQ(::pread(descriptor_, read.data(), read.size(), 0), static_cast<ssize_t>(read.size()));
  for (std::size_t j = 0; j < read.size(); ++j) {
    const bool changed = j >= 64 * kMegabyte && j < 64 * kMegabyte + 4;
    ASSERT_EQ(read[j], changed ? 'x' : static_cast<char>(j / kMegabyte + 1)) << j;
  }
}

TEST(WriteBehind, NamesAMissingFile) {
  EXPECT_TRUE(contains(message_of<std::runtime_error>([] { WriteBehind("/nowhere/run.bag"); }), "/nowhere/run.bag"));
}

}  // namespace
}  // namespace platoon
