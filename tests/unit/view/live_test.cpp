// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "view/detections_json.hpp"
#include "view/drive_record.hpp"
#include "view/live_state.hpp"

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

pose::PoseEstimate make_pose(std::int64_t utime, double x_m, double yaw_rad = 0.0) {
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
  for (int k = 0; k < 10; ++k) state.take(make_pose(k, 0.1 * k));
  EXPECT_EQ(events_of(state, seen)["path"]["points"].size(), 20u);
  state.take(make_pose(10, 1.0));
  const json more = events_of(state, seen)["path"];
  EXPECT_FALSE(more["is_new"]);
  EXPECT_EQ(more["points"], json({1.0, 0.0}));
  pose::TrajectoryPage page;
  page.utime = 10;
  page.poses = {make_pose(0, 5.0), make_pose(5, 6.0)};
  state.take(page);
  const json anew = events_of(state, seen)["path"];
  EXPECT_TRUE(anew["is_new"]);
  EXPECT_EQ(anew["points"], json({5.0, 0.0, 6.0, 0.0, 1.0, 0.0}));
}

TEST(LivePath, IsBoundedHoweverLongTheDrive) {
  LivePath path;
  for (int k = 0; k < 200000; ++k) path.take(make_pose(k, 0.1 * k));
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
    edge.kind = k % 3 == 0 ? mapping::EdgeKind::kHeadland : mapping::EdgeKind::kAisle;
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

mapping::Landmark make_landmark(std::int32_t id, double x_m, int num_observations = 5) {
  mapping::Landmark l;
  l.id = id;
  l.x_m = x_m;
  l.num_observations = num_observations;
  return l;
}

mapping::MapTile tile_of(std::vector<mapping::Landmark> landmarks,
                         std::vector<std::int32_t> removed = {}) {
  mapping::MapTile tile;
  tile.landmarks = std::move(landmarks);
  tile.removed_ids = std::move(removed);
  return tile;
}

TEST(LiveMap, WhoAsksAgainIsToldOnlyWhatIsNew) {
  LiveMap map(3);
  map.take(tile_of({make_landmark(1, 0.0), make_landmark(2, 1.0), make_landmark(3, 2.0, 2)}));
  LiveMap::Changes first = map.changes_since(0, 100);
  ASSERT_EQ(first.landmarks.size(), 2u) << "the third was seen too seldom";
  EXPECT_TRUE(map.changes_since(first.revision, 100).landmarks.empty());

  map.take(tile_of({make_landmark(1, 0.0), make_landmark(2, 1.5)}));
  const LiveMap::Changes second = map.changes_since(first.revision, 100);
  ASSERT_EQ(second.landmarks.size(), 1u) << "the refresh of the first says nothing new";
  EXPECT_EQ(second.landmarks[0].x_m, 1.5);
}

TEST(LiveMap, NumbersFoundHereStayThroughTilesThatHaveNone) {
  LiveMap map(1);
  map.take(tile_of({make_landmark(1, 0.0)}));
  mapping::Landmark numbered = make_landmark(1, 0.0);
  numbered.row = 4;
  numbered.position = 7;
  map.number({numbered});
  map.take(tile_of({make_landmark(1, 0.25)}));
  const auto landmarks = map.landmarks();
  ASSERT_EQ(landmarks.size(), 1u);
  EXPECT_EQ(landmarks[0].row, 4);
  EXPECT_EQ(landmarks[0].position, 7);
  EXPECT_EQ(landmarks[0].x_m, 0.25);
}

// Onlookers that ask whenever they like, for as few as they like, all come to the same map.
TEST(LiveMap, EveryOnlookerConverges) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const auto draw = [&random](int most) {
      return std::uniform_int_distribution<int>(0, most - 1)(random);
    };
    LiveMap map(1);
    std::map<std::int32_t, double> truth;
    struct Onlooker {
      std::int64_t revision = 0;
      std::map<std::int32_t, double> known;
    };
    std::vector<Onlooker> onlookers(4);
    const auto ask = [&](Onlooker& onlooker, std::size_t num_most) {
      const LiveMap::Changes changes = map.changes_since(onlooker.revision, num_most);
      EXPECT_LE(changes.landmarks.size() + changes.removed_ids.size(), num_most);
      for (const auto& l : changes.landmarks) onlooker.known[l.id] = l.x_m;
      for (const std::int32_t id : changes.removed_ids) onlooker.known.erase(id);
      onlooker.revision = changes.revision;
    };
    for (int step = 0; step < 500; ++step) {
      const std::int32_t id = 1 + draw(30);
      if (draw(4) == 0) {
        map.take(tile_of({}, {id}));
        truth.erase(id);
      } else {
        map.take(tile_of({make_landmark(id, step)}));
        truth[id] = step;
      }
      Onlooker& onlooker = onlookers[static_cast<std::size_t>(draw(4))];
      if (draw(3) == 0) ask(onlooker, static_cast<std::size_t>(1 + draw(5)));
    }
    for (Onlooker& onlooker : onlookers) {
      while (onlooker.revision != map.revision()) ask(onlooker, 3);
      EXPECT_EQ(onlooker.known, truth) << "seed " << seed;
    }
  }
}

TEST(LiveMap, ShowsExactlyWhatItIsTold) {
  LiveMap map(1);
  mapping::Landmark a = make_landmark(1, 0.0), b = make_landmark(2, 0.0);
  map.show({a, b});
  const std::int64_t revision = map.revision();
  map.show({a, b});
  EXPECT_EQ(map.revision(), revision) << "nothing is new";
  b.x_m = 1.0;
  map.show({b});
  const LiveMap::Changes changes = map.changes_since(revision, 10);
  ASSERT_EQ(changes.landmarks.size(), 1u);
  EXPECT_EQ(changes.landmarks[0].x_m, 1.0);
  EXPECT_EQ(changes.removed_ids, std::vector<std::int32_t>{1});
  map.show({a, b});
  EXPECT_EQ(map.landmarks().size(), 2u);
}

detection::Detections make_scan(std::int64_t utime) {
  detection::Detections scan;
  scan.utime = utime;
  return scan;
}

mapping::MapTile make_tile(std::int64_t utime, std::int32_t id, double x_m) {
  mapping::MapTile tile = tile_of({make_landmark(id, x_m)});
  tile.utime = utime;
  return tile;
}

json news_of(const DriveRecord& record, DriveProgress& seen) {
  return json::parse("{" + record.news_json(seen) + "}");
}

TEST(DriveRecord, AStepIsToldOnceItsPoseIsKnown) {
  DriveRecord record(1);
  record.take(make_scan(1500000));
  DriveProgress seen;
  record.take(make_pose(1000000, 0.0, 3.0));
  EXPECT_EQ(news_of(record, seen)["num_steps"], 0);
  record.take(make_pose(2000000, 1.0, -3.0));  // turned on over pi
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
    record.take(make_pose(k, k));
  }
  record.take(make_tile(0, 7, 1.0));
  record.take(make_tile(1, 7, 1.001));  // a millimetre
  record.take(make_tile(2, 7, 1.2));
  mapping::MapTile gone = tile_of({}, {7, 99});
  gone.utime = 3;
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
  record.take(make_pose(1, 0.0));
  record.take(make_tile(1, 3, 1.0));
  record.take(make_tile(1, 4, 2.0));
  mapping::Landmark last = make_landmark(4, 2.0001);
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
    record.take(make_pose(k, k));
  }
  pose::TrajectoryPage page;
  page.utime = 1;
  page.poses = {make_pose(0, 5.0), make_pose(1, 6.0)};
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
    record.take(make_pose(k, k));
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
