// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <string>

#include "io/map/map_csv.hpp"
#include "io/map/stored_map.hpp"
#include "mapper/mapper_process.hpp"
#include "node/mapper/row_drive.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::procs {
namespace {

namespace fs = std::filesystem;

/// Kills of the test; the environment's ORCHARD_KILLS asks for more.
int num_kills() {
  const char* wanted = std::getenv("ORCHARD_KILLS");
  return wanted != nullptr ? std::atoi(wanted) : 12;
}

/// Maps on from step `k`, saves everything after each one, and tells which it has saved.
[[noreturn]] void map_until_killed(const std::string& folder, int k, int told) {
  MapperProcess process;
  const io::Config config;
  const auto node = process.make_node(config, 5, folder, false);
  node->start({});
  RowDrive drive(*node);
  for (;; ++k) {
    drive.step(k, k);
    process.save(*node, {k % 2 == 0 ? bus::SaveKind::kFull : bus::SaveKind::kQuick, {}});
    if (::write(told, &k, sizeof(k)) != sizeof(k)) ::_exit(1);
  }
}

TEST(KilledMapper, NeverLosesWhatWasSavedNorAnId) {
  const io::TestFolder folder;
  std::mt19937 random(3);
  int saved = -1;
  std::map<std::int32_t, mapping::Landmark> known;
  for (int kill = 0; kill < num_kills(); ++kill) {
    int channel[2];
    ASSERT_EQ(::pipe(channel), 0);
    const pid_t pid = ::fork();
    if (pid == 0) map_until_killed(folder.path(), saved + 1, channel[1]);
    ::close(channel[1]);
    // One more save as a rule, then a moment in the middle of the next ones.
    int step = 0;
    if (::read(channel[0], &step, sizeof(step)) == sizeof(step)) saved = step;
    ::usleep(random() % 120000);
    ASSERT_EQ(::kill(pid, SIGKILL), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(pid, &status, 0), pid);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it ended by itself: " << status;
    while (::read(channel[0], &step, sizeof(step)) == sizeof(step)) saved = step;
    ::close(channel[0]);

    // what lies there can be read whole
    const auto on_disk = io::read_map_csv(folder / "map.csv");
    ASSERT_GT(io::read_stored_map(folder.path()).landmarks.size(), 0u);
    const std::string package = io::read_bytes(folder / "map.gpkg");
    ASSERT_EQ(package.substr(0, 15), "SQLite format 3");
    // SQLite's own count of its pages, big-endian at 28, and their size at 16
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(package[i]); };
    ASSERT_EQ(package.size(),
              std::size_t{256} * byte(16) *
                  ((byte(28) << 24) + (byte(29) << 16) + (byte(30) << 8) + byte(31)));
    // and is gone on with
    {
      io::MapFolderLock place(folder.path());
      JournaledMapper again(io::Config{}, 5, place);
      again.start({});
      ASSERT_TRUE(again.notes().empty()) << again.notes().front();
      ASSERT_GE(again.num_replayed()[static_cast<std::size_t>(bus::Channel::kPose)], saved + 1);
      std::map<std::int32_t, mapping::Landmark> now;
      for (const mapping::Landmark& l : again.mapper().landmarks()) now[l.id] = l;
      for (const mapping::Landmark& l : on_disk) ASSERT_EQ(now.count(l.id), 1u) << l.id;
      for (const auto& [id, l] : known) {
        ASSERT_EQ(now.count(id), 1u) << id;
        ASSERT_NEAR(now[id].x_m, l.x_m, 0.05) << id;
      }
      known = now;
      saved =
          static_cast<int>(again.num_replayed()[static_cast<std::size_t>(bus::Channel::kPose)]) - 1;
    }
    for (const auto& entry : fs::directory_iterator(folder.path())) {
      ASSERT_NE(entry.path().filename().string().front(), '.') << "a temporary of a killed save";
    }
  }
  EXPECT_GT(known.size(), 2u);
}

}  // namespace
}  // namespace orchard::procs
