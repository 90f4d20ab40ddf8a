// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper_process.hpp"

#include <gtest/gtest.h>

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
  Process(const io::Config& config, const std::string& folder, std::int64_t hash = 5)
      : place(folder), node(config, hash, place), drive(node) {
    node.start({});
  }
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

TEST(JournaledMapper, ItGoesOnToTheLastByteOfItsMessages) {
  MapperNode never_killed(rig());
  RowDrive drive(never_killed);
  const io::TestFolder folder;
  auto process = std::make_unique<Process>(rig(), folder.path());
  int k = 0;
  for (; k < 300; ++k) {
    drive.step(k, k);
    process->drive.step(k, k);
    if (k % 100 == 49) {  // stopped, and started again
      never_killed.flush(kNowhere);
      process->node.flush(kNowhere);
    }
    if (k % 25 == 24) {  // killed
      process->node.commit();
      process.reset();
      process = std::make_unique<Process>(rig(), folder.path());
    }
  }
  EXPECT_TRUE(process->node.notes().empty());
  EXPECT_EQ(process->node.num_replayed()[static_cast<std::size_t>(bus::Channel::kPose)], 300);
  const std::string expected = outputs_of(never_killed, drive, k, k + 50);
  EXPECT_EQ(outputs_of(process->node, process->drive, k, k + 50), expected);
  EXPECT_EQ(table_of(process->node.mapper()), table_of(never_killed));
}

TEST(JournaledMapper, WhileItResumesOthersWork) {
  const io::TestFolder folder;
  {
    Process process(rig(), folder.path());
    for (int k = 0; k < 500; ++k) process.drive.step(k, k);
    process.node.commit();
  }
  io::MapFolderLock place(folder.path());
  JournaledMapper node(rig(), 5, place);
  int num_calls = 0;
  node.start([&] { ++num_calls; });
  EXPECT_EQ(num_calls, 6) << "of 3000 messages";
}

TEST(JournaledMapper, AMapOfAProgramWithSnapshotsIsSetAside) {
  const io::TestFolder folder;
  {
    Process process(rig(), folder.path());
    for (int k = 0; k < 10; ++k) process.drive.step(k, k);
    process.node.commit();
  }
  io::write_bytes(folder / "mapper.snapshot", "all before");
  Process process(rig(), folder.path());
  EXPECT_EQ(process.node.mapper().num_landmarks(), 0u);
  ASSERT_EQ(process.node.notes().size(), 1u);
  EXPECT_NE(process.node.notes().front().find("in mapper.snapshot"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "mapper.snapshot"));
}

TEST(JournaledMapper, WhatTheJournalLacksIsSaid) {
  const io::TestFolder folder;
  {
    Process process(rig(), folder.path());
    process.drive.step(0, 0);
    process.node.commit();
  }
  {
    io::Journal journal(folder / "mapper.journal", 5,
                        io::read_journal(folder / "mapper.journal", 5).num_good_bytes);
    const std::string lost(2 << 20, 'x');
    for (int k = 0; k < 70; ++k) journal.add(0, lost.data(), lost.size());
    journal.commit();
  }
  Process process(rig(), folder.path());
  ASSERT_EQ(process.node.notes().size(), 1u);
  EXPECT_EQ(process.node.notes().front().find("6 messages came while the disk was full"), 0u)
      << process.node.notes().front();
  EXPECT_NE(process.node.warning().find("lacks what they showed"), std::string::npos);
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
