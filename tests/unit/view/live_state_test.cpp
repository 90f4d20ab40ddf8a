// SPDX-License-Identifier: BSD-3-Clause
#include "view/live_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

TEST(LiveState, TheLastStateIsTheFinishedMap) {
  // Two rows of three trees, a hedge, a stray; while the map grows the page counts them otherwise.
  mapping::FinishedMap map;
  for (int i = 0; i < 6; ++i) {
    mapping::Landmark tree;
    tree.id = i + 1;
    tree.label = detection::Label::kTree;
    tree.num_observations = i == 5 ? 1 : 9;  // by the camera once, by the laser often
    tree.x_m = 2.0 * (i % 3);
    tree.y_m = 4.0 * (i / 3);
    tree.row = 1 + i / 3;
    tree.position = 1 + i % 3;
    map.landmarks.push_back(tree);
  }
  mapping::Landmark hedge;
  hedge.id = 7;
  hedge.num_observations = 9;
  hedge.y_m = 9.0;
  hedge.length_m = 6.5;
  hedge.direction_rad = 0.25;
  map.landmarks.push_back(hedge);
  map.omitted = {{8, mapping::Omission::kSpurious}, {9, mapping::Omission::kPart}};
  for (int k = 0; k < 450; ++k) {  // more than one part holds
    mapping::NavigationEdge edge;
    edge.id = k + 1;
    edge.from = 2 * k + 1;
    edge.to = 2 * k + 2;
    edge.kind = k % 3 == 0 ? mapping::EdgeKind::kHeadland : mapping::EdgeKind::kAlley;
    edge.row_left = k;
    edge.width_m = 2.0 + 0.001 * k;
    for (int i = 0; i <= k % 40; ++i) edge.line_map.push_back({0.5 * i, 1.0 * k});
    edge.line_map.push_back({0.5 * k, 1.0 + k});
    map.graph.edges.push_back(edge);
  }
  LiveState state(make_rig(), 3);
  mapping::MapTile growing;
  growing.utime = 5'000'000;
  for (std::int32_t id = 1; id <= 9; ++id) {
    mapping::Landmark l = id <= 7 ? map.landmarks[static_cast<std::size_t>(id) - 1] : hedge;
    l.id = id;
    l.row = l.position = 0;
    l.length_m = l.direction_rad = 0.0;
    growing.landmarks.push_back(l);
  }
  state.take(growing);
  std::vector<mapping::Landmark> preview = state.landmarks();
  for (mapping::Landmark& l : preview) l.row = l.position = 40;
  state.take_rows(preview, "");
  std::vector<mapping::MapWays> parts = mapping::map_ways_of(map, growing.utime);
  EXPECT_GT(parts.size(), 2u);
  std::reverse(parts.begin(), parts.end());
  for (const mapping::MapWays& part : parts) {
    EXPECT_EQ(state.ways(), nullptr);
    state.take(part);
  }
  mapping::MapTile last = growing;
  last.landmarks = map.landmarks;
  for (mapping::Landmark& l : last.landmarks) l.length_m = l.direction_rad = 0.0;  // as on the wire
  for (const mapping::OmittedLandmark& l : map.omitted) last.removed_ids.push_back(l.id);
  state.take(last);
  const std::vector<mapping::Landmark> shown = state.landmarks();
  ASSERT_EQ(shown.size(), map.landmarks.size());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    EXPECT_EQ(shown[i].id, map.landmarks[i].id);
    EXPECT_EQ(shown[i].row, map.landmarks[i].row);
    EXPECT_EQ(shown[i].position, map.landmarks[i].position);
    EXPECT_EQ(shown[i].length_m, map.landmarks[i].length_m);
    EXPECT_EQ(shown[i].direction_rad, map.landmarks[i].direction_rad);
  }
  ASSERT_NE(state.ways(), nullptr);
  ASSERT_EQ(state.ways()->edges.size(), map.graph.edges.size());
  for (const mapping::NavigationEdge& edge : state.ways()->edges) {
    const mapping::NavigationEdge& sent = map.graph.edges[static_cast<std::size_t>(edge.id) - 1];
    EXPECT_EQ(edge.line_map, sent.line_map);
    EXPECT_EQ(edge.width_m, sent.width_m);
    EXPECT_EQ(edge.kind, sent.kind);
  }
  growing.utime += 100'000;  // the drive goes on
  state.take(growing);
  EXPECT_EQ(state.ways(), nullptr);
}

}  // namespace
}  // namespace orchard::view
