// SPDX-License-Identifier: BSD-3-Clause
#include "view/live_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "view/bitmap.hpp"

namespace orchard::view {
namespace {

using nlohmann::json;

detection::Rig make_rig() {
  laser::LaserConfig laser;
  laser.mount_x_m = 0.5;
  laser.mount_y_m = 0.0;
  laser.mount_yaw_rad = 0.0;
  return {laser, geometry::CameraConfig{}, detection::DetectorConfig{}};
}

pose::PoseEstimate make_pose(std::int64_t utime, double x_m, double yaw_rad) {
  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.x_m = x_m;
  pose.yaw_rad = yaw_rad;
  return pose;
}

std::map<std::string, json> events_of(const LiveState& state, ViewerProgress& seen) {
  std::map<std::string, json> events;
  bool is_more = true;
  while (is_more) {
    for (const std::string& text : state.events_for(seen, is_more)) {
      EXPECT_EQ(text.find('\n'), text.npos) << "an event is one line";
      const json event = json::parse(text);
      events[event["kind"]] = event;
    }
  }
  return events;
}

// The robot drives along x, turned to the left; a beam straight ahead of 2 m, a scanner half a
// metre before base: at half the time between two poses it meets (0.5, 2.5).
TEST(LiveState, LaysTheScanWhereTheRobotWas) {
  LiveState state(make_rig(), 1);
  laser::Scan scan;
  scan.utime = 1500000;
  scan.bearing_step_rad = 0.01;
  scan.range_max_m = 10.0;
  scan.ranges_m = {2.0f, 0.0f};
  state.take(make_pose(1000000, 0.0, M_PI / 2));
  state.take(scan);
  ViewerProgress seen;
  EXPECT_EQ(events_of(state, seen).count("scan"), 0u) << "nobody knows yet where that was";
  state.take(make_pose(2000000, 1.0, M_PI / 2));
  const auto events = events_of(state, seen);
  ASSERT_EQ(events.count("scan"), 1u);
  const json points = events.at("scan")["points"];
  ASSERT_EQ(points.size(), 2u) << "a beam without a return is no point";
  EXPECT_NEAR(points[0].get<double>(), 0.5, 0.006);
  EXPECT_NEAR(points[1].get<double>(), 2.5, 0.006);
  EXPECT_EQ(events.at("pose")["x"], 1.0);
  EXPECT_TRUE(events_of(state, seen).empty()) << "all has been told";
}

TEST(LiveState, ThePictureIsTheOneThatItsDetectionsAreOf) {
  LiveState state(make_rig(), 1);
  for (int k = 1; k <= 3; ++k) {
    vision::Image image;
    image.utime = k;
    image.data = {static_cast<std::uint8_t>(k)};
    state.take(image);
  }
  detection::Detections detections;
  detections.utime = 5;
  detections.image_utime = 2;
  state.take(detections);
  ASSERT_TRUE(state.picture());
  EXPECT_EQ(state.picture()->utime, 2);
  EXPECT_EQ(state.picture()->bytes, std::string("\x02"));
  ViewerProgress seen;
  EXPECT_TRUE(events_of(state, seen)["look"]["trunks"].empty());
}

TEST(LiveState, APathThatIsCorrectedIsToldAnew) {
  LiveState state(make_rig(), 1);
  ViewerProgress seen;
  for (int k = 0; k < 10; ++k) state.take(make_pose(k, 0.1 * k, 0.0));
  EXPECT_EQ(events_of(state, seen)["path"]["points"].size(), 20u);
  state.take(make_pose(10, 1.0, 0.0));
  const json more = events_of(state, seen)["path"];
  EXPECT_FALSE(more["is_new"]);
  EXPECT_EQ(more["points"], json({1.0, 0.0}));
  pose::TrajectoryPage page;
  page.utime = 10;
  page.poses = {make_pose(0, 5.0, 0.0), make_pose(5, 6.0, 0.0)};
  state.take(page);
  const json anew = events_of(state, seen)["path"];
  EXPECT_TRUE(anew["is_new"]);
  EXPECT_EQ(anew["points"], json({5.0, 0.0, 6.0, 0.0, 1.0, 0.0}));
}

TEST(LivePath, IsBoundedHoweverLongTheDrive) {
  LivePath path;
  for (int k = 0; k < 200000; ++k) path.take(make_pose(k, 0.1 * k, 0.0));
  EXPECT_LT(path.points().size(), LivePath::kPointsMax);
  EXPECT_GT(path.points().size(), LivePath::kPointsMax / 4);
  EXPECT_NEAR(path.points().back().x(), 20000.0, 5.0);
}

// Numbers by the format's description: header of 54 bytes, rows from the bottom, padded to four.
TEST(Bitmap, HoldsThePixels) {
  vision::Image image;
  image.encoding = vision::Encoding::kBgr8;
  image.width_px = 1;
  image.height_px = 2;
  image.data = {1, 2, 3, 4, 5, 6};
  const std::string bytes = bitmap(image);
  ASSERT_EQ(bytes.size(), 54u + 8u);
  EXPECT_EQ(bytes.substr(0, 2), "BM");
  EXPECT_EQ(bytes.substr(54), std::string("\4\5\6\0\1\2\3\0", 8));
  image.data.pop_back();
  EXPECT_TRUE(bitmap(image).empty()) << "too few bytes";
}

}  // namespace
}  // namespace orchard::view
