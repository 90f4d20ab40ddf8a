// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/journaled_mapper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "bus/messages/codec.hpp"
#include "io/map/map_csv.hpp"
#include "node/mapper/row_drive.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::procs {
namespace {

namespace fs = std::filesystem;
using JournalReading = io::JournalReading;

const bus::Outbox kNowhere = [](const bus::Message&) {};
io::Config rig(pose::PoseMode mode = pose::PoseMode::kFixesAndOdometry) {
  io::Config config;
  config.camera.enabled = false;
  config.pose.mode = mode;
  return config;
}

std::string table_of(const MapperNode& mapper) { return io::map_csv(mapper.finished().landmarks); }

/// A mapper process, as far as its map goes.
struct Process {
  Process(const io::Config& config, const std::string& folder, std::int64_t hash = 5,
          int snapshot_period = JournaledMapper::kSnapshotPeriod)
      : place(folder), node(config, hash, place, snapshot_period), drive(node) {}
  io::MapFolderLock place;
  JournaledMapper node;
  RowDrive drive;
};

TEST(JournaledMapper, KilledAnywhereItGoesOnAsIfItHadNotBeen) {
  MapperNode never_killed(rig());
  RowDrive drive(never_killed);
  for (int k = 0; k < 200; ++k) drive.step(k, k);
  never_killed.flush(kNowhere);

  const io::TestFolder folder;
  auto process = std::make_unique<Process>(rig(), folder.path());
  for (int k = 0; k < 200; ++k) {
    process->drive.step(k, k);
    if (k % 10 != 9) continue;
    process->node.commit();
    if (k % 30 == 29) {  // killed
      process.reset();
      process = std::make_unique<Process>(rig(), folder.path());
      EXPECT_EQ(process->node.num_replayed()[static_cast<std::size_t>(bus::Channel::kPose)], k + 1);
    }
  }
  process->node.flush(kNowhere);
  EXPECT_EQ(table_of(process->node.mapper()), table_of(never_killed));
  EXPECT_GT(never_killed.landmarks().size(), 8u);
  EXPECT_TRUE(process->node.notes().empty());
  EXPECT_TRUE(process->node.warning().empty());
}

/// Every MAP message as text, and the table: what others see of a mapper.
std::string outputs_of(bus::Node& node, RowDrive& drive, int from, int to) {
  std::string text;
  const bus::Outbox note = [&](const bus::Message& message) {
    const auto bytes = bus::encode(message);
    text.append(bytes.begin(), bytes.end());
  };
  for (int k = from; k < to; ++k) drive.step(k, k, note);
  node.flush(note);
  return text;
}

TEST(JournaledMapper, FromASnapshotItGoesOnToTheLastByteOfItsMessages) {
  for (const int period : {1, 37, 200}) {
    MapperNode never_killed(rig());
    RowDrive drive(never_killed);
    const io::TestFolder folder;
    auto process = std::make_unique<Process>(rig(), folder.path(), 5, period);
    int k = 0;
    std::uintmax_t largest = 0;
    for (; k < 300; ++k) {
      drive.step(k, k);
      process->drive.step(k, k);
      if (k % 5 == 4) process->node.commit();
      largest = std::max(largest, fs::file_size(folder / "mapper.journal"));
      if (k % 25 == 24) {  // killed
        process.reset();
        process = std::make_unique<Process>(rig(), folder.path(), 5, period);
      }
    }
    EXPECT_TRUE(process->node.notes().empty());
    EXPECT_EQ(process->node.num_replayed()[static_cast<std::size_t>(bus::Channel::kPose)], 300);
    EXPECT_LT(largest, 40'000u) << "the journal is no longer than what a snapshot lacks";
    const std::string expected = outputs_of(never_killed, drive, k, k + 50);
    EXPECT_EQ(outputs_of(process->node, process->drive, k, k + 50), expected) << period;
    EXPECT_EQ(table_of(process->node.mapper()), table_of(never_killed));
  }
}

TEST(JournaledMapper, ASnapshotOrWhatItKeepsThatIsDamagedIsNotGoneOnWith) {
  for (const char* name : {"mapper.snapshot", "mapper.chunks", "mapper.journal"}) {
    const io::TestFolder folder;
    {
      Process process(rig(), folder.path(), 5, 100);
      for (int k = 0; k < 100; ++k) process.drive.step(k, k);
      process.node.commit();
      for (int k = 100; k < 110; ++k) process.drive.step(k, k);
      process.node.commit();
      for (int k = 110; k < 114; ++k) process.drive.step(k, k);
      process.node.commit();
    }
    std::string bytes = io::read_bytes(folder / name);
    ASSERT_GT(bytes.size(), 100u) << name;
    bytes[60] = static_cast<char>(~bytes[60]);
    io::write_bytes(folder / name, bytes);
    Process process(rig(), folder.path());
    EXPECT_EQ(process.node.mapper().num_landmarks(), 0u) << name;
    ASSERT_EQ(process.node.notes().size(), 1u) << name;
    EXPECT_NE(process.node.notes().front().find("damaged"), std::string::npos) << name;
  }
}

TEST(JournaledMapper, KilledBetweenASnapshotAndItsNewJournalItTakesNothingTwice) {
  const io::TestFolder folder;
  std::string journal;
  std::string before;
  {
    Process process(rig(), folder.path(), 5, 1 << 30);
    for (int k = 0; k < 100; ++k) process.drive.step(k, k);
    process.node.commit();
    journal = io::read_bytes(folder / "mapper.journal");  // as it was when the snapshot was made
    process.node.flush(kNowhere);
  }
  {
    Process process(rig(), folder.path(), 5, 1);
    before = table_of(process.node.mapper());
    process.node.commit();  // a snapshot, for what was replayed
  }
  for (const std::string& left : {journal, std::string()}) {
    io::write_bytes(folder / "mapper.journal", left);
    Process process(rig(), folder.path());
    EXPECT_TRUE(process.node.notes().empty());
    EXPECT_EQ(table_of(process.node.mapper()), before);
  }
}

TEST(JournaledMapper, StoppedAndStartedAgainItKeepsEveryId) {
  const io::TestFolder folder;
  std::string before;
  {
    Process process(rig(), folder.path());
    for (int k = 0; k < 100; ++k) process.drive.step(k, k);
    process.node.flush(kNowhere);
    process.node.commit();
    before = table_of(process.node.mapper());
  }
  Process process(rig(), folder.path());
  EXPECT_EQ(table_of(process.node.mapper()), before);
  const std::size_t num_before = process.node.mapper().landmarks().size();
  for (int k = 100; k < 160; ++k) process.drive.step(k, k);
  EXPECT_GT(process.node.mapper().landmarks().size(), num_before);
  EXPECT_EQ(process.node.mapper().landmarks().front().id, 1);
}

TEST(JournaledMapper, AMapThatItDidNotMakeIsSetAside) {
  const io::TestFolder folder;
  io::write_bytes(folder / "map.csv", "another's\n");
  Process process(rig(), folder.path());
  EXPECT_FALSE(fs::exists(folder / "map.csv"));
  ASSERT_EQ(process.node.notes().size(), 1u);
  const std::string note = process.node.notes().front();
  const std::string aside = note.substr(note.rfind(' ') + 1);
  EXPECT_EQ(io::read_bytes(aside + "/map.csv"), "another's\n");
  EXPECT_NE(process.node.warning().find("cannot be resumed"), std::string::npos);
}

TEST(JournaledMapper, ADamagedJournalAndAnotherConfigurationBeginAnewAndKeepTheOld) {
  const io::TestFolder folder;
  {
    Process process(rig(), folder.path());
    for (int k = 0; k < 100; ++k) {
      process.drive.step(k, k);
      if (k % 10 == 9) process.node.commit();
    }
  }
  { EXPECT_NE(Process(rig(), folder.path(), 6).node.notes().front().find("another config"), 0u); }
  // back to the first journal, with a byte of it turned
  std::string journal;
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    if (entry.is_directory()) journal = io::read_bytes(entry.path() / "mapper.journal");
  }
  ASSERT_GT(journal.size(), 1000u);
  journal[500] = static_cast<char>(~journal[500]);
  io::write_bytes(folder / "mapper.journal", journal);
  Process process(rig(), folder.path());
  EXPECT_EQ(process.node.mapper().num_landmarks(), 0u);
  EXPECT_NE(process.node.notes().front().find("damaged"), std::string::npos);
}

TEST(JournaledMapper, PosesThatBeginAnewEndAMapOfTheirOwnOriginOnly) {
  for (const auto mode : {pose::PoseMode::kFixesAndOdometry, pose::PoseMode::kSlam}) {
    const bool is_own_origin = mode == pose::PoseMode::kSlam;
    const io::TestFolder folder;
    Process process(rig(mode), folder.path());
    int num_saved = 0;
    process.node.before_new_map([&](const MapperNode& earlier) {
      EXPECT_GT(earlier.num_landmarks(), 4u);
      io::write_bytes(folder / "map.csv", "saved");
      ++num_saved;
    });
    for (int k = 0; k < 100; ++k) process.drive.step(k, k);
    for (int k = 100; k < 130; ++k) process.drive.step(k, k - 100);
    EXPECT_EQ(num_saved, is_own_origin ? 1 : 0);
    EXPECT_EQ(process.node.notes().size(), is_own_origin ? 1u : 0u);
    const auto landmarks = process.node.mapper().landmarks();
    EXPECT_EQ(landmarks.front().x_m > 8.0, is_own_origin) << landmarks.front().x_m;
  }
}

}  // namespace
}  // namespace orchard::procs
