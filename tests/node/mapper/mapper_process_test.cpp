// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <random>
#include <string>

#include "bus/messages/codec.hpp"
#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/stored_map.hpp"
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
    process->node.commit()();
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

/// Keeps the messages of a drive.
class Collected : public bus::Node {
 public:
  std::string_view name() const override { return "collected"; }
  std::vector<bus::Channel> inputs() const override { return {}; }
  void handle(const bus::Message& input, const bus::Outbox&) override { messages.push_back(input); }
  void flush(const bus::Outbox&) override {}
  std::vector<bus::Message> messages;
};

TEST(JournaledMapper, ClocksThatAreSetBackMeanwhileOrBeforeLoseNothing) {
  MapperNode never_set(rig());
  Collected collected;
  RowDrive drive(never_set), sent(collected);
  for (int k = 0; k < 200; ++k) {
    drive.step(k, k);
    sent.step(k, k);
  }
  never_set.flush(kNowhere);
  for (const std::size_t set_at : {550u, 600u, 640u}) {  // of 1200 messages; killed at 600
    const io::TestFolder folder;
    std::unique_ptr<Process> process;
    std::unique_ptr<bus::NodeHost> host;
    for (std::size_t i = 0; i < collected.messages.size(); ++i) {
      if (i % 300 == 0) {
        if (process) process->node.commit()();
        host.reset();
        process.reset();
        process = std::make_unique<Process>(rig(), folder.path());
        host = std::make_unique<bus::NodeHost>(process->node, [](bus::Output&&) {});
        for (const auto& [channel, at] : process->node.resumed()) host->resume(channel, at);
      }
      bus::Message message = collected.messages[i];
      const std::int64_t back_us = i < set_at ? 0 : 5'000'000;
      std::visit([back_us](auto& m) { m.utime += 1'000'000'000 - back_us; }, message);
      if (auto* detections = std::get_if<detection::Detections>(&message)) {
        for (auto& trunk : detections->trunks) trunk.utime = detections->utime;
      }
      host->receive(message);
    }
    host->flush();
    host->flush();
    EXPECT_EQ(table_of(process->node.mapper()), table_of(never_set)) << set_at;
    EXPECT_TRUE(process->node.notes().empty());
  }
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
      process->node.commit()();
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
    process.node.commit()();
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
    process.node.commit()();
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
    process.node.commit()();
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

TEST(JournaledMapper, APathBesideItsFixesIsToldInStatus) {
  const io::TestFolder folder;
  Process process(rig(), folder.path());
  drive_beside_fixes(process.node);
  EXPECT_NE(bus::warning_text(process.node).find("GNSS fixes lie beside the path"),
            std::string::npos);
}

TEST(JournaledMapper, StoppedAndStartedAgainItKeepsEveryId) {
  const io::TestFolder folder;
  std::string before;
  {
    Process process(rig(), folder.path());
    for (int k = 0; k < 100; ++k) process.drive.step(k, k);
    process.node.flush(kNowhere);
    process.node.commit()();
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
      if (k % 10 == 9) process.node.commit()();
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

using ::testing::HasSubstr;

/// One scan that sees a tree at each of the first `num_trees` metres, from the origin.
void see_trees(MapperNode& mapper, int seq, int num_trees) {
  const bus::Outbox nowhere = [](const bus::Message&) {};
  detection::Detections detections;
  detections.utime = 1000000 + 100000 * seq;
  detections.seq = seq;
  for (int tree = 0; tree < num_trees; ++tree) {
    detection::Detection d;
    d.centre_x_m = tree;
    d.centre_y_m = 1.0;
    d.covariance = {1e-4, 0, 1e-4};
    d.width_m = 0.09;
    d.width_sd_m = 0.01;
    d.label = detection::Label::kTree;
    d.roc_tree = 0.9f;
    detections.trunks.push_back(d);
  }
  pose::PoseEstimate pose;
  pose.utime = detections.utime;
  pose.seq = seq;
  mapper.handle(detections, nowhere);
  mapper.handle(pose, nowhere);
}

void write(const bus::Writing& writing) {
  if (writing) writing();
}

bus::SaveRequest request(bus::SaveKind kind) {
  bus::SaveRequest request;
  request.kind = kind;
  request.traffic.num_in[static_cast<std::size_t>(bus::Channel::kDetections)] = 17;
  return request;
}

/// Scans are not what this is about.
io::Config without_scans() {
  io::Config config;
  config.mapper.existence.scan_wait_s = 0.0;
  return config;
}

class MapSaverTest : public ::testing::Test {
 protected:
  MapSaverTest() {
    for (int seq = 0; seq < 5; ++seq) see_trees(mapper, seq, 2);
    write(saver.save(mapper, request(bus::SaveKind::kQuick)));
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder / name); }
  void remove(const std::string& name) { std::filesystem::remove(folder / name); }

  io::TestFolder folder;
  MapperNode mapper{without_scans()};
  MapSaver saver{folder.path(), 77};
};

TEST_F(MapSaverTest, TheFirstSaveMakesAllFiles) {
  for (const char* name :
       {"map.csv", "map.gpkg", "map.png", "map.svg", "map.html", "trajectory.csv"}) {
    EXPECT_TRUE(exists(name)) << name;
  }
  const std::string summary = io::read_bytes(folder / "summary.json");
  EXPECT_THAT(summary, HasSubstr("\"in_DETECTIONS\": 17"));
  EXPECT_THAT(summary, HasSubstr("\"mapper_late\": 0"));
  EXPECT_THAT(summary, HasSubstr("\"source\": \"live\""));
  EXPECT_THAT(summary, ::testing::Not(HasSubstr("\"version\": \"\"")));
}

TEST_F(MapSaverTest, LaterQuickOnesWriteTheTableAloneAndOnlyAChangedOne) {
  const std::string before = io::read_bytes(folder / "map.csv");
  remove("map.png");
  remove("map.csv");
  write(saver.save(mapper, request(bus::SaveKind::kQuick)));
  EXPECT_FALSE(exists("map.csv")) << "nothing has changed";
  for (int seq = 5; seq < 10; ++seq) see_trees(mapper, seq, 3);
  write(saver.save(mapper, request(bus::SaveKind::kQuick)));
  EXPECT_NE(io::read_bytes(folder / "map.csv"), before);
  EXPECT_FALSE(exists("map.png"));
}

TEST_F(MapSaverTest, FullOnesWriteAllOnceTheDriveHasGrownByAnEighth) {
  for (int seq = 5; seq < 80; ++seq) see_trees(mapper, seq, 2);
  write(saver.save(mapper, request(bus::SaveKind::kFull)));
  remove("map.png");
  for (int seq = 80; seq < 89; ++seq) see_trees(mapper, seq, 2);
  write(saver.save(mapper, request(bus::SaveKind::kFull)));
  EXPECT_FALSE(exists("map.png")) << "9 of 80 poses more";
  see_trees(mapper, 89, 2);
  write(saver.save(mapper, request(bus::SaveKind::kFull)));
  EXPECT_TRUE(exists("map.png")) << "10 of 80 poses more";
}

TEST_F(MapSaverTest, AFullOneThatCouldNotBeWrittenIsWrittenAgain) {
  for (int seq = 5; seq < 80; ++seq) see_trees(mapper, seq, 2);
  remove("map.html");
  std::filesystem::create_directories(folder / "map.html/in_the_way");
  EXPECT_THROW(write(saver.save(mapper, request(bus::SaveKind::kFull))), io::FileError);
  std::filesystem::remove_all(folder / "map.html");
  write(saver.save(mapper, request(bus::SaveKind::kFull)));
  EXPECT_TRUE(exists("map.html")) << "although the drive has not grown";
}

TEST_F(MapSaverTest, AWritingShowsTheMapFromWhichItWasTaken) {
  for (int seq = 5; seq < 10; ++seq) see_trees(mapper, seq, 3);
  const bus::Writing of_three = saver.save(mapper, request(bus::SaveKind::kQuick));
  for (int seq = 10; seq < 15; ++seq) see_trees(mapper, seq, 5);
  write(of_three);
  const std::string table = io::read_bytes(folder / "map.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 3) << table;
}

TEST_F(MapSaverTest, NothingOfAMapIsWrittenOnceAnotherHasBegun) {
  for (int seq = 5; seq < 10; ++seq) see_trees(mapper, seq, 3);
  const bus::Writing of_earlier = saver.save(mapper, request(bus::SaveKind::kQuick));
  remove("map.csv");
  saver.begin_new_map();
  write(of_earlier);
  EXPECT_FALSE(exists("map.csv"));
}

TEST_F(MapSaverTest, FullAndFinalOnesWriteAll) {
  for (int seq = 5; seq < 10; ++seq) see_trees(mapper, seq, 2);
  for (const auto kind : {bus::SaveKind::kFull, bus::SaveKind::kFinal}) {
    remove("map.png");
    remove("map.csv");
    write(saver.save(mapper, request(kind)));
    EXPECT_TRUE(exists("map.png"));
    EXPECT_TRUE(exists("map.csv"));
  }
}

/// Drives past a row while each save is written in a thread of its own, as in a live process.
/// `restarts`: orchard-pose begins anew in the middle.
void drive_and_save_beside(bus::Node& node, MapperProcess& process, bool restarts) {
  RowDrive drive(node);
  std::future<void> writing;
  for (int k = 0; k < 200; ++k) {
    drive.step(k, restarts && k >= 100 ? k - 100 : k);
    if (k % 20 != 9) continue;
    if (writing.valid()) writing.get();
    const bus::SaveKind kind = k % 40 == 9 ? bus::SaveKind::kFull : bus::SaveKind::kQuick;
    bus::Writing write = process.save(node, request(kind));
    if (write) writing = std::async(std::launch::async, std::move(write));
  }
  if (writing.valid()) writing.get();
  node.flush(kNowhere);
  write(process.save(node, request(bus::SaveKind::kFinal)));
}

TEST(MapperProcess, SavesWrittenBesideTheInputsChangeNoMap) {
  MapperNode never_saved(rig());
  RowDrive drive(never_saved);
  for (int k = 0; k < 200; ++k) drive.step(k, k);
  never_saved.flush(kNowhere);

  const io::TestFolder folder;
  MapperProcess process;
  const auto node = process.make_node(rig(), 5, folder.path(), false);
  node->start({});
  drive_and_save_beside(*node, process, false);
  EXPECT_EQ(io::read_bytes(folder / "map.csv"), table_of(never_saved));
}

TEST(MapperProcess, AMapIsSetAsideWholeWhileASaveIsWritten) {
  MapperNode earlier(rig(pose::PoseMode::kOdometry));
  RowDrive drive(earlier);
  for (int k = 0; k < 100; ++k) drive.step(k, k);

  const io::TestFolder folder;
  MapperProcess process;
  const auto node = process.make_node(rig(pose::PoseMode::kOdometry), 5, folder.path(), false);
  node->start({});
  drive_and_save_beside(*node, process, true);
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    if (entry.path().filename().string().rfind("earlier_", 0) != 0) continue;
    EXPECT_EQ(io::read_bytes(entry.path() / "map.csv"), table_of(earlier));
    return;
  }
  ADD_FAILURE() << "no map was set aside";
}

TEST(MapSaver, WithoutAFolderNothingIsSaved) {
  EXPECT_FALSE(MapSaver("", 0).save(MapperNode{io::Config{}}, request(bus::SaveKind::kFinal)));
  EXPECT_FALSE(std::filesystem::exists("map.csv"));
}

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
    write(process.save(*node, {k % 2 == 0 ? bus::SaveKind::kFull : bus::SaveKind::kQuick, {}}));
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
