#include "stochastic_platoon/run/io/atomic_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

using Names = std::vector<std::string>;

// The message of the exception that `action` throws; empty if it throws none.
template <typename Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(WriteAtomically, PutsTheContentIntoTheFileAndLeavesNothingBeside) {
  const TemporaryFolder folder;
  write_atomically(folder / "results.csv", "a,b\n1,2\n");
  EXPECT_EQ(content_of(folder / "results.csv"), "a,b\n1,2\n");
  EXPECT_EQ(folder.entries(), Names{"results.csv"});
}

TEST(WriteAtomically, ReplacesWhatWasThere) {
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

TEST(WriteAtomically, TakesThePlaceOfALeftOverPart) {
  const TemporaryFolder folder;
  folder.file("results.csv.part", "half of somethi");
  write_atomically(folder / "results.csv", "whole");
  EXPECT_EQ(content_of(folder / "results.csv"), "whole");
  EXPECT_EQ(folder.entries(), Names{"results.csv"});
}

TEST(WriteAtomically, NamesTheFileAndTheReasonWhenItCannot) {
  const TemporaryFolder folder;
  const std::string missing = folder / "none/results.csv";
  const std::string said = message_of([&] { write_atomically(missing, "x"); });
  EXPECT_NE(said.find(missing), std::string::npos);
  EXPECT_NE(said.find("cannot be written: No such file or directory"), std::string::npos);
}

TEST(WriteAtomically, LeavesNothingBesideWhenItCannot) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "results.csv");
  const std::string said = message_of([&] { write_atomically(folder / "results.csv", "x"); });
  EXPECT_NE(said.find(folder / "results.csv"), std::string::npos);
  EXPECT_EQ(folder.entries(), Names{"results.csv"});
}

TEST(WriteAtomically, WritesIntoTheWorkingFolder) {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const std::string said = message_of([] { write_atomically("results.csv", "x"); });
  std::filesystem::current_path(before);
  EXPECT_EQ(said, "");
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

TEST(SyncAndRename, NamesTheFileThatIsNotThere) {
  const TemporaryFolder folder;
  const std::string said = message_of([&] { sync_and_rename(folder / "none", folder / "a"); });
  EXPECT_NE(said.find(folder / "none"), std::string::npos);
}

TEST(RequireWritableFolder, MakesItWithItsParentsAndLeavesItEmpty) {
  const TemporaryFolder folder;
  for (const char* name : {"a/b/c", "d/", "."}) EXPECT_NO_THROW(require_writable_folder(folder / name)) << name;
  EXPECT_TRUE(std::filesystem::is_empty(folder / "a/b/c"));
  EXPECT_NO_THROW(require_writable_folder(folder / "a/b/c"));
}

TEST(RequireWritableFolder, LeavesWhatIsThere) {
  const TemporaryFolder folder;
  folder.file("kept", "content");
  require_writable_folder(folder.path());
  EXPECT_EQ(folder.entries(), Names{"kept"});
  EXPECT_EQ(content_of(folder / "kept"), "content");
}

TEST(RequireWritableFolder, NamesThePathThatIsOrLiesBelowAFile) {
  const TemporaryFolder folder;
  const std::string file = folder.file("file", "content");
  for (const std::string& path : {file, file + "/below"}) {
    const std::string said = message_of([&] { require_writable_folder(path); });
    EXPECT_EQ(said.find(path + ": cannot be made: "), 0u) << said;
  }
  EXPECT_EQ(content_of(file), "content");
}

}  // namespace
}  // namespace platoon
