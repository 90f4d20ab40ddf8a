// SPDX-License-Identifier: BSD-3-Clause
#include "io/folder.hpp"

#include <gtest/gtest.h>

#include "io/file_error.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

TEST(MakeFolder, MakesThoseAboveItAndLeavesOneThatIsThere) {
  const TestFolder folder;
  make_folder(folder / "a/b/c");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b/c"));
  make_folder(folder / "a/b");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b/c"));
}

TEST(MakeFolder, SaysWhichFolderWhyAndWhatToDoInstead) {
  const TestFolder folder;
  std::ofstream(folder / "file") << "not a folder";
  try {
    make_folder(folder / "file/below", "give another one with --out");
    FAIL() << "a folder below a file";
  } catch (const FileError& error) {
    EXPECT_EQ(std::string(error.what()), folder /
                                             "file/below: cannot be created as a folder (Not a "
                                             "directory); give another one with --out");
  }
  EXPECT_THROW(make_folder(folder / "file"), FileError);  // a file of that name is there
}

}  // namespace
}  // namespace orchard::io
