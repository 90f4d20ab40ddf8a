// SPDX-License-Identifier: BSD-3-Clause
#include "view/drive_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace orchard::view {
namespace {

using nlohmann::json;

detection::Detections make_scan(std::int64_t utime) {
  detection::Detections scan;
  scan.utime = utime;
  return scan;
}

pose::PoseEstimate make_robot(std::int64_t utime, double x_m, double yaw_rad = 0.0) {
  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.x_m = x_m;
  pose.yaw_rad = yaw_rad;
  return pose;
}

mapping::MapTile make_tile(std::int64_t utime, std::int32_t id, double x_m) {
  mapping::Landmark landmark;
  landmark.id = id;
  landmark.x_m = x_m;
  landmark.num_observations = 5;
  mapping::MapTile tile;
  tile.utime = utime;
  tile.landmarks = {landmark};
  return tile;
}

json news_of(const DriveRecord& record, DriveProgress& seen) {
  return json::parse("{" + record.news_json(seen) + "}");
}

TEST(DriveRecord, AStepIsToldOnceItsPoseIsKnown) {
  DriveRecord record(1);
  record.take(make_scan(1500000));
  DriveProgress seen;
  record.take(make_robot(1000000, 0.0, 3.0));
  EXPECT_EQ(news_of(record, seen)["num_steps"], 0);
  record.take(make_robot(2000000, 1.0, -3.0));  // turned on over pi
  json news = news_of(record, seen);
  ASSERT_EQ(news["x"].size(), 1u);
  EXPECT_DOUBLE_EQ(news["x"][0], 0.5);
  EXPECT_NEAR(std::abs(news["yaw"][0].get<double>()), M_PI, 1e-3);
  EXPECT_TRUE(news_of(record, seen)["x"].empty()) << "it was told already";
}

TEST(DriveRecord, TheMapGrowsByChangesThatCanBeSeen) {
  DriveRecord record(1);
  for (int k = 0; k < 4; ++k) {
    record.take(make_scan(k));
    record.take(make_robot(k, k));
  }
  record.take(make_tile(0, 7, 1.0));
  record.take(make_tile(1, 7, 1.001));  // a millimetre
  record.take(make_tile(2, 7, 1.2));
  mapping::MapTile gone;
  gone.utime = 3;
  gone.removed_ids = {7, 99};
  record.take(gone);
  DriveProgress seen;
  const json changes = news_of(record, seen)["changes"];
  EXPECT_EQ(changes["step"], json({0, 2, 3}));
  EXPECT_EQ(changes["removed"], json({0, 0, 1}));
  EXPECT_EQ(changes["landmarks"]["x"], json({1.0, 1.2, 1.2}));
}

TEST(DriveRecord, ItEndsWithTheFinishedMap) {
  DriveRecord record(1);
  record.take(make_scan(1));
  record.take(make_robot(1, 0.0));
  record.take(make_tile(1, 3, 1.0));
  record.take(make_tile(1, 4, 2.0));
  mapping::Landmark last = make_tile(1, 4, 2.0001).landmarks[0];
  last.row = 1;
  record.finish({last});
  DriveProgress seen;
  const json news = news_of(record, seen);
  EXPECT_TRUE(news["is_done"]);
  const json& columns = news["changes"]["landmarks"];
  EXPECT_EQ(columns["id"], json({3, 4, 3, 4}));
  EXPECT_EQ(news["changes"]["removed"], json({0, 0, 1, 0}));
  EXPECT_EQ(columns["row"][3], 1);
}

TEST(DriveRecord, APathHoldsFromItsStepOn) {
  DriveRecord record(1);
  for (int k = 0; k < 3; ++k) {
    record.take(make_scan(k));
    record.take(make_robot(k, k));
  }
  pose::TrajectoryPage page;
  page.utime = 1;
  page.poses = {make_robot(0, 5.0), make_robot(1, 6.0)};
  record.take(page);
  DriveProgress seen;
  const json paths = news_of(record, seen)["paths"];
  ASSERT_EQ(paths.size(), 1u);
  EXPECT_EQ(paths[0]["step"], 1);
  EXPECT_EQ(paths[0]["points"], json({5.0, 0.0, 6.0, 0.0}));
}

TEST(DriveRecord, WhoIsFarBehindIsToldInParts) {
  DriveRecord record(1);
  for (int k = 0; k < 9000; ++k) {
    record.take(make_scan(k));
    record.take(make_robot(k, k));
    record.take(make_tile(k, k, k));
  }
  record.finish({});
  DriveProgress seen;
  std::size_t steps = 0, changes = 0;
  bool is_more = true;
  for (int round = 0; is_more && round < 100; ++round) {
    const json news = news_of(record, seen);
    EXPECT_LE(news["x"].size(), 4000u);
    steps += news["x"].size();
    changes += news["changes"]["step"].size();
    is_more = news["is_more"];
  }
  EXPECT_EQ(steps, 9000u);
  EXPECT_EQ(changes, 18000u);  // each came, and went with the finished map
}

}  // namespace
}  // namespace orchard::view
