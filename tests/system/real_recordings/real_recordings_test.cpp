// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "io/config/config.hpp"
#include "io/map/map_csv.hpp"
#include "io/recording/recording_folder.hpp"
#include "system/cli/cli_fixture.hpp"
#include "system/real_recordings/clear_trees.hpp"
#include "system/real_recordings/return_consistency.hpp"
#include "system/real_recordings/tree_repeat.hpp"

namespace orchard::test {
namespace {

const std::string kData = ORCHARD_DATA_DIR;

/// Imports and maps a recording with the `orchard` tool; skips where it is absent.
class RealRecording : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "orchard_real_XXXXXX";
    ASSERT_NE(mkdtemp(folder_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static bool is_here(const std::string& name) {
    return cli_test::exists(kData + "/" + name + "/sensors.yaml");
  }

  std::vector<mapping::Landmark> map_of(const std::string& name, const std::string& rig) {
    const char* made = std::getenv("ORCHARD_PULLALLY");  // by map_pullally.sh
    if (made != nullptr && name == "pullally_drive_1" && rig == "pullally.yaml") {
      map_ = std::string(made) + "/map";
      return io::read_map_csv(map_ + "/map.csv");
    }
    const std::string log = folder_ + "/" + name + ".lcm";
    map_ = folder_ + "/map";
    const auto imported = cli_test::orchard({"import", kData + "/" + name, "--out", log});
    EXPECT_EQ(imported.exit_code, 0) << imported.err;
    const auto mapped = cli_test::orchard(
        {"map", log, "--config", ORCHARD_SOURCE_DIR "/config/" + rig, "--out", map_, "--strict"});
    EXPECT_EQ(mapped.exit_code, 0) << mapped.err;
    EXPECT_EQ(mapped.err, "");
    if (mapped.exit_code != 0) return {};
    return io::read_map_csv(map_ + "/map.csv");
  }

  std::vector<pose::PoseEstimate> path_of_map() const {
    return io::read_trajectory_csv(map_ + "/trajectory.csv");
  }

 private:
  std::string folder_, map_;
};

/// Rows of so many trees or more: what stands in line in a hedge or a bush is shorter.
int num_rows_of(const std::vector<mapping::Landmark>& map, int num_trees) {
  std::map<int, int> trees_of;
  for (const mapping::Landmark& l : map) {
    if (l.row > 0) ++trees_of[l.row];
  }
  return static_cast<int>(std::count_if(trees_of.begin(), trees_of.end(),
                                        [&](const auto& row) { return row.second >= num_trees; }));
}

/// The sharpest turn between a row as a whole and the way from one of its trees to the next [rad].
double sharpest_turn_rad(const std::vector<mapping::Landmark>& map) {
  std::map<int, std::map<int, Eigen::Vector2d>> rows;
  for (const auto& l : map) {
    if (l.row > 0 && l.position > 0) rows[l.row][l.position] = {l.x_m, l.y_m};
  }
  double sharpest_rad = 0.0;
  for (const auto& [number, places] : rows) {
    const Eigen::Vector2d chord = places.rbegin()->second - places.begin()->second;
    for (auto at = places.begin(), next = std::next(at); next != places.end(); ++at, ++next) {
      const Eigen::Vector2d step = next->second - at->second;
      sharpest_rad = std::max(
          sharpest_rad,
          std::acos(std::clamp(step.dot(chord) / (step.norm() * chord.norm()), -1.0, 1.0)));
    }
  }
  return sharpest_rad;
}

struct Thing {
  Eigen::Vector2d p_map;
  bool is_tree = false;
};

/// What stands at Pullally in the frame of a drive's track, labelled by eye from pictures of its
/// scans.
std::vector<Thing> things_of_drive(const std::string& drive) {
  std::ifstream file(ORCHARD_SOURCE_DIR "/tests/experiments/pullally_things.csv");
  std::vector<Thing> things;
  for (std::string of, x, y, what; std::getline(file, of, ',') && std::getline(file, x, ',') &&
                                   std::getline(file, y, ',') && std::getline(file, what);) {
    if (of == drive) things.push_back({{std::stod(x), std::stod(y)}, what == "tree"});
  }
  return things;
}

TEST_F(RealRecording, PullallysBushesAreNoSureTrees) {
  const std::string name = "pullally_drive_2";
  if (!is_here(name)) GTEST_SKIP() << "the recording " << name << " is not here";
  const auto things = things_of_drive("2");
  ASSERT_GE(things.size(), 100u);
  int num_trees = 0, num_others = 0;  // with a probability above 0.9
  for (const mapping::Landmark& l : map_of(name, "pullally.yaml")) {
    if (l.probability <= 0.9) continue;
    const auto distance_m = [&](const Thing& t) {
      return (t.p_map - Eigen::Vector2d(l.x_m, l.y_m)).norm();
    };
    const auto nearest = std::min_element(
        things.begin(), things.end(),
        [&](const Thing& a, const Thing& b) { return distance_m(a) < distance_m(b); });
    ++(nearest->is_tree && distance_m(*nearest) < 0.55 ? num_trees : num_others);
  }
  EXPECT_GE(num_trees, 20);
  EXPECT_LE(num_others, 2);
}

TEST_F(RealRecording, PullallysClearTreesAreOneLandmarkEach) {
  const std::string name = "pullally_drive_1";
  if (!is_here(name)) GTEST_SKIP() << "the recording " << name << " is not here";
  const auto recording = io::read_recording_folder(kData + "/" + name);
  const auto trees = find_clear_trees(recording);
  ASSERT_GE(trees.size(), 30u);  // its description says about 34; a few more stand in the hedge
  const auto map = map_of(name, "pullally.yaml");
  const auto comparison = compare(trees, map);
  SCOPED_TRACE(report(trees, comparison));
  EXPECT_LE(comparison.num_tree_landmarks, 90);
  // Of things less than a third of the rows' spacing apart one is the tree, and what is seen
  // seldom, at the ends of rows, comes and goes with a scan: up to five are missing, by the scans
  // lost.
  EXPECT_GE(comparison.num_with(1), static_cast<int>(trees.size()) - 5);
  for (std::size_t i = 0; i < trees.size() / 3; ++i) {  // those seen best
    EXPECT_EQ(comparison.num_landmarks[i], 1) << trees[i].x_m << ", " << trees[i].y_m;
  }
  EXPECT_EQ(comparison.num_doubled(), 0);
  EXPECT_EQ(num_rows_of(map, 6), 5);
  EXPECT_LT(sharpest_turn_rad(map), 0.5) << "a row is straight, give or take a bend";
  EXPECT_LE(comparison.median_distance_m(), 0.1);
  const MappedDrive drive{map, path_of_map()};
  const TreeScatter scatter = tree_scatter(recording, drive, trees);
  EXPECT_LE(scatter.median_m(), 0.10) << report(scatter);

  // From the laser alone: the same trees, but for what stands in the bushes at the west end.
  const MappedDrive by_laser{map_of(name, "pullally_laser_only.yaml"), path_of_map()};
  const SameTrees same = same_trees(trees, drive, by_laser);
  EXPECT_LE(same.num_missing, 3) << report(same);  // measured: three of 36; none is wanted
  EXPECT_LE(same.num_extra, 1) << report(same);    // measured: one; none is wanted
}

TEST_F(RealRecording, KoalasLoopClosesOnPolesThatStandOnce) {
  const std::string name = "koala_poles";
  if (!is_here(name)) GTEST_SKIP() << "the recording " << name << " is not here";
  const auto map = map_of(name, "koala.yaml");
  EXPECT_GE(map.size(), 10u);
  EXPECT_LE(map.size(), 15u);
  for (std::size_t i = 0; i < map.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GT(std::hypot(map[i].x_m - map[j].x_m, map[i].y_m - map[j].y_m), 1.0);
    }
  }
  const auto recording = io::read_recording_folder(kData + "/" + name);
  const auto mount = io::load_config(ORCHARD_SOURCE_DIR "/config/koala.yaml").laser;
  const auto by_map = return_consistency(recording, path_of_map(), mount, 30.0);
  const auto by_wheels = return_consistency(recording, dead_reckoned(recording), mount, 30.0);
  ASSERT_TRUE(by_map && by_wheels);
  EXPECT_LE(by_map->shift_m, 0.6);     // measured: 0.47; no loop is closed
  EXPECT_GT(by_wheels->shift_m, 1.0);  // there is something to close
}

TEST_F(RealRecording, UrgGeometryFrontIsMapped) {
  const std::string name = "urg_geometry_front";
  if (!is_here(name)) GTEST_SKIP() << "the recording " << name << " is not here";
  EXPECT_FALSE(map_of(name, "urg_front.yaml").empty());
}

TEST_F(RealRecording, UrgGeometryRearIsMapped) {
  const std::string name = "urg_geometry_rear";
  if (!is_here(name)) GTEST_SKIP() << "the recording " << name << " is not here";
  EXPECT_FALSE(map_of(name, "urg_rear.yaml").empty());
}

}  // namespace
}  // namespace orchard::test
