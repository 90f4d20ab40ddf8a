// SPDX-License-Identifier: BSD-3-Clause
#include "view/live_map.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace orchard::view {
namespace {

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
  mapping::Landmark a, b;
  a.id = 1, b.id = 2;
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

}  // namespace
}  // namespace orchard::view
