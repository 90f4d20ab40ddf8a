// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/map_folder_lock.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <set>
#include <string>

#include "io/file_error.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

/// The number of a process that has ended.
std::string dead_pid() {
  const pid_t pid = ::fork();
  if (pid == 0) ::_exit(0);
  ::waitpid(pid, nullptr, 0);
  return std::to_string(pid);
}

TEST(MapFolderLock, MakesTheFolderAndLeavesNothingInIt) {
  const TestFolder folder;
  const MapFolderLock place(folder / "a/b");
  EXPECT_TRUE(names_in(place.folder()).empty());
  EXPECT_FALSE(place.holds_map());
}

TEST(MapFolderLock, RefusesWhatCannotBeWritten) {
  const TestFolder folder;
  write_bytes(folder / "file", "");
  EXPECT_THROW(MapFolderLock{folder / "file"}, FileError);
  EXPECT_THROW(MapFolderLock{"/proc/no/folder"}, FileError);
  if (::geteuid() != 0) {
    fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THROW(MapFolderLock{folder.path()}, FileError);
    fs::permissions(folder.path(), fs::perms::owner_all);
  }
}

TEST(MapFolderLock, IsOneMappersAlone) {
  const TestFolder folder;
  {
    const MapFolderLock place(folder.path());
    EXPECT_THROW(MapFolderLock{folder.path()}, FileError);
  }
  EXPECT_NO_THROW(MapFolderLock{folder.path()});
}

TEST(MapFolderLock, RemovesTemporariesOfDeadProcessesOfOursAlone) {
  const TestFolder folder;
  const std::string dead = dead_pid(), alive = std::to_string(::getppid());
  for (const std::string& name :
       {".map." + dead + "-0.csv", ".map." + dead + "-12.gpkg", ".trajectory_2." + dead + "-3.csv",
        ".summary." + dead + "-1.json", ".trial." + dead + "-0.csv"}) {
    write_bytes(folder / name, "half");
  }
  const std::set<std::string> kept{".map." + alive + "-0.csv", ".notes." + dead + "-0.csv",
                                   "map." + dead + "-0.csv",   ".map.csv",
                                   ".map." + dead + ".csv",    "map.csv"};
  for (const std::string& name : kept) write_bytes(folder / name, "whole");
  const MapFolderLock place(folder.path());
  EXPECT_EQ(place.num_removed_temporaries(), 5);
  EXPECT_EQ(names_in(folder.path()), kept);
}

TEST(MapFolderLock, SetsAsideWhatIsOfAMapUnderItsTime) {
  const TestFolder folder;
  for (const char* name : {"map.csv", "map.gpkg", "trajectory_2.csv", "x.journal", "notes.txt"}) {
    write_bytes(folder / name, name);
  }
  // 2026-03-04 05:06:07 UTC by its count of seconds since 1970
  ASSERT_EQ(std::system(("touch -d @1772600767 '" + folder.path() + "'/*").c_str()), 0);
  MapFolderLock place(folder.path());
  EXPECT_TRUE(place.holds_map());
  const std::string aside = place.set_aside({"x.journal"});
  EXPECT_EQ(aside, folder / "earlier_20260304T050607Z");
  EXPECT_EQ(names_in(folder.path()),
            (std::set<std::string>{"earlier_20260304T050607Z", "notes.txt"}));
  EXPECT_EQ(read_bytes(aside + "/map.csv"), "map.csv");
  EXPECT_EQ(names_in(aside).size(), 4u);
  EXPECT_FALSE(place.holds_map());
  EXPECT_EQ(place.set_aside({"x.journal"}), "");
  write_bytes(folder / "map.csv", "second");
  ASSERT_EQ(std::system(("touch -d @1772600767 '" + folder.path() + "'/map.csv").c_str()), 0);
  EXPECT_EQ(place.set_aside({}), folder / "earlier_20260304T050607Z_2");
}

}  // namespace
}  // namespace orchard::io
