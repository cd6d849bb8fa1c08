#include "stochastic_platoon/run/io/atomic_file.hpp"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <filesystem>
#include <stdexcept>

#include "unit/messages.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

using Names = std::vector<std::string>;

// The error of `action`.
template <typename Action>
std::string error_of(const Action& action) {
  return message_of<std::runtime_error>(action);
}

TEST(WriteAtomically, WritesTheContentAndNoOtherFile) {
  const TemporaryFolder folder;
  write_atomically(folder / "results.csv", "a,b\n1,2\n");
  EXPECT_EQ(content_of(folder / "results.csv"), "a,b\n1,2\n");
  EXPECT_EQ(folder.entries(), Names{"results.csv"});
}

TEST(WriteAtomically, ReplacesTheFile) {
  const TemporaryFolder folder;
  write_atomically(folder / "results.csv", std::string(100000, 'x'));
  write_atomically(folder / "results.csv", "short");
  EXPECT_EQ(content_of(folder / "results.csv"), "short");
  EXPECT_EQ(folder.entries(), Names{"results.csv"});
}

TEST(WriteAtomically, KeepsEveryByte) {
  const TemporaryFolder folder;
  std::string bytes;
  for (int j = 0; j < 300000; ++j) bytes.push_back(static_cast<char>(j % 256));
  write_atomically(folder / "bytes", bytes);
  EXPECT_EQ(content_of(folder / "bytes"), bytes);
  write_atomically(folder / "empty", "");
  EXPECT_EQ(content_of(folder / "empty"), "");
}

TEST(WriteAtomically, ReplacesALeftoverPart) {
  const TemporaryFolder folder;
  folder.file("results.csv.part", "half of somethi");
  write_atomically(folder / "results.csv", "whole");
  EXPECT_EQ(content_of(folder / "results.csv"), "whole");
  EXPECT_EQ(folder.entries(), Names{"results.csv"});
}

TEST(WriteAtomically, NamesTheFileAndTheReasonOfAnError) {
  const TemporaryFolder folder;
  const std::string missing = folder / "none/results.csv";
  const std::string error = error_of([&] { write_atomically(missing, "x"); });
  EXPECT_TRUE(contains(error, missing));
  EXPECT_TRUE(contains(error, "cannot be written: No such file or directory"));
}

TEST(WriteAtomically, LeavesNoOtherFileBehindAfterAnError) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "results.csv");
  EXPECT_TRUE(contains(error_of([&] { write_atomically(folder / "results.csv", "x"); }), folder / "results.csv"));
  EXPECT_EQ(folder.entries(), Names{"results.csv"});
}

TEST(WriteAtomically, WritesIntoTheWorkingFolder) {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  EXPECT_EQ(error_of([] { write_atomically("results.csv", "x"); }), "");
  std::filesystem::current_path(before);
  EXPECT_EQ(content_of(folder / "results.csv"), "x");
}

TEST(SyncAndRename, GivesTheFileItsName) {
  const TemporaryFolder folder;
  folder.file("a.active", "content");
  folder.file("a", "old");
  sync_and_rename(folder / "a.active", folder / "a");
  EXPECT_EQ(content_of(folder / "a"), "content");
  EXPECT_EQ(folder.entries(), Names{"a"});
}

TEST(SyncAndRename, NamesAMissingFile) {
  const TemporaryFolder folder;
  EXPECT_TRUE(contains(error_of([&] { sync_and_rename(folder / "none", folder / "a"); }), folder / "none"));
}

TEST(RequireWritableFolder, CreatesAnEmptyFolderWithItsParents) {
  const TemporaryFolder folder;
  for (const char* name : {"a/b/c", "d/", "."}) EXPECT_NO_THROW(require_writable_folder(folder / name)) << name;
  EXPECT_TRUE(std::filesystem::is_empty(folder / "a/b/c"));
  EXPECT_NO_THROW(require_writable_folder(folder / "a/b/c"));
}

TEST(RequireWritableFolder, KeepsExistingFiles) {
  const TemporaryFolder folder;
  folder.file("kept", "content");
  require_writable_folder(folder.path());
  EXPECT_EQ(folder.entries(), Names{"kept"});
  EXPECT_EQ(content_of(folder / "kept"), "content");
}

TEST(RequireWritableFolder, NamesAPathAtOrBelowAFile) {
  const TemporaryFolder folder;
  const std::string file = folder.file("file", "content");
  for (const std::string& path : {file, file + "/below"}) {
    EXPECT_TRUE(begins_with(error_of([&] { require_writable_folder(path); }), path + ": cannot be made: "));
  }
  EXPECT_EQ(content_of(file), "content");
}

TEST(RequirePossibleFolder, NamesTheSameAndMakesNothing) {
  const TemporaryFolder folder;
  const std::string file = folder.file("file", "content");
  for (const std::string& path : {file, file + "/below", folder / std::string(300, 'a')}) {
    const std::string error = error_of([&] { require_possible_folder(path); });
    EXPECT_TRUE(begins_with(error, path + ": cannot be made: "));
    EXPECT_EQ(error, error_of([&] { require_writable_folder(path); }));
  }
  for (const char* name : {"a/b/c", "d/", ".", "a/../b"})
    EXPECT_NO_THROW(require_possible_folder(folder / name)) << name;
  EXPECT_EQ(folder.entries(), Names{"file"});
  EXPECT_NO_THROW(require_possible_folder("made/below"));
}

TEST(WriteAtomically, ReplacesNothingButRegularFiles) {
  const TemporaryFolder folder;
  const std::string fifo = folder / "fifo", part = folder / "results.csv.part";
  for (const std::string& name : {fifo, part}) ASSERT_EQ(::mkfifo(name.c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/null", folder / "null");
  EXPECT_EQ(error_of([&] { write_atomically(fifo, "x"); }),
            fifo + ": must be a new file or a regular one: File exists");
  EXPECT_TRUE(
      contains(error_of([&] { write_atomically(folder / "results.csv", "x"); }), part + ": must be a new file"));
  EXPECT_TRUE(contains(error_of([&] { write_atomically(folder / "null", "x"); }), "must be a new file"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "null"));
  EXPECT_TRUE(std::filesystem::is_fifo(fifo));
}

}  // namespace
}  // namespace platoon
