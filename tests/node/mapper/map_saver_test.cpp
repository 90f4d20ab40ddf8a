// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "unit/io/test_folder.hpp"

namespace orchard::procs {
namespace {

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
    saver.save(mapper, request(bus::SaveKind::kQuick));
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
  saver.save(mapper, request(bus::SaveKind::kQuick));
  EXPECT_FALSE(exists("map.csv")) << "nothing has changed";
  for (int seq = 5; seq < 10; ++seq) see_trees(mapper, seq, 3);
  saver.save(mapper, request(bus::SaveKind::kQuick));
  EXPECT_NE(io::read_bytes(folder / "map.csv"), before);
  EXPECT_FALSE(exists("map.png"));
}

TEST_F(MapSaverTest, FullAndFinalOnesWriteAll) {
  for (const auto kind : {bus::SaveKind::kFull, bus::SaveKind::kFinal}) {
    remove("map.png");
    remove("map.csv");
    saver.save(mapper, request(kind));
    EXPECT_TRUE(exists("map.png"));
    EXPECT_TRUE(exists("map.csv"));
  }
}

TEST(MapSaver, WithoutAFolderNothingIsSaved) {
  MapSaver("", 0).save(MapperNode{io::Config{}}, request(bus::SaveKind::kFinal));
  EXPECT_FALSE(std::filesystem::exists("map.csv"));
}

}  // namespace
}  // namespace orchard::procs
