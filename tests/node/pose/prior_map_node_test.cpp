// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "pose/pose_node.hpp"
#include "unit/pose/prior_map/prior_world.hpp"

namespace orchard::procs {
namespace {

namespace fs = std::filesystem;

/// A folder of its own that goes with the test.
class PriorMapNode : public testing::Test {
 protected:
  PriorMapNode()
      : folder_(fs::temp_directory_path() /
                (std::string("orchard_prior_map_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    config_.pose.mode = pose::PoseMode::kPriorMap;
    config_.pose.prior_map.map_file = (folder_ / "map.csv").string();
  }
  ~PriorMapNode() override { fs::remove_all(folder_); }

  void write_map(const std::vector<pose::PriorLandmark>& trees, double factor = 1.0,
                 int num_observations = 50) {
    std::vector<mapping::Landmark> landmarks;
    for (const pose::PriorLandmark& tree : trees) {
      mapping::Landmark l;
      l.id = static_cast<std::int32_t>(landmarks.size() + 1);
      l.label = detection::Label::kTree;
      l.num_observations = num_observations;
      l.x_m = factor * tree.p_map.x();
      l.y_m = factor * tree.p_map.y();
      l.width_m = tree.width_m;
      landmarks.push_back(l);
    }
    std::ofstream(config_.pose.prior_map.map_file) << io::map_csv(landmarks);
  }

  std::string map_text() const {
    std::ostringstream text;
    text << std::ifstream(config_.pose.prior_map.map_file).rdbuf();
    return text.str();
  }

  /// The sentence with which the node refuses the map.
  std::string refusal() const {
    try {
      PoseNode node(config_);
    } catch (const io::FileError& error) {
      return error.what();
    }
    return {};
  }

  fs::path folder_;
  io::Config config_;
};

bus::Message message_of(const pose::Measurement& measurement) {
  if (const auto* odometry = std::get_if<pose::Odometry>(&measurement)) return *odometry;
  return std::get<detection::Detections>(measurement);
}

TEST_F(PriorMapNode, FindsItsPlaceInTheMapOfAFileAndLeavesTheFileAlone) {
  const pose::PriorWorld world = pose::prior_world(3);
  write_map(pose::mapped(world, 3));
  const std::string before = map_text();
  config_.pose.prior_map.map_file = folder_.string();  // the folder serves as well
  PoseNode node(config_);
  EXPECT_EQ(node.inputs(),
            (std::vector<bus::Channel>{bus::Channel::kOdometry, bus::Channel::kDetections}));
  EXPECT_EQ(node.warning().find("LOST"), 0u);

  std::vector<pose::PoseEstimate> poses;
  const bus::Outbox send = [&](bus::Message m) {
    poses.push_back(std::get<pose::PoseEstimate>(m));
  };
  Eigen::Vector3d truth = Eigen::Vector3d::Zero();
  pose::drive(world, pose::way_through(world), {{100.0, 125.0}}, 3, {},
              [&](const pose::Measurement& m, const Eigen::Vector3d& T, double) {
                node.handle(message_of(m), send);
                truth = T;
                return true;
              });
  node.flush(send);
  ASSERT_FALSE(poses.empty());
  EXPECT_LT(std::hypot(poses.back().x_m - truth.x(), poses.back().y_m - truth.y()), 0.15);
  EXPECT_EQ(node.warning(), "");
  for (std::size_t i = 1; i < poses.size(); ++i) EXPECT_GT(poses[i].utime, poses[i - 1].utime);
  config_.pose.prior_map.map_file = (folder_ / "map.csv").string();
  EXPECT_EQ(map_text(), before);
}

TEST_F(PriorMapNode, RefusesAMissingFileByName) {
  EXPECT_NE(refusal().find("map.csv"), std::string::npos) << refusal();
  config_.pose.prior_map.map_file = folder_.string();  // a folder without a map
  EXPECT_NE(refusal().find("map.csv"), std::string::npos) << refusal();
}

TEST_F(PriorMapNode, RefusesAnEmptyMapAndOneWhoseTreesWereSeenOnce) {
  write_map({});
  EXPECT_NE(refusal().find("no landmark"), std::string::npos) << refusal();
  write_map(pose::prior_world(1).trees, 1.0, 1);
  EXPECT_NE(refusal().find("no landmark"), std::string::npos) << refusal();
}

TEST_F(PriorMapNode, RefusesAMapInMillimetres) {
  write_map(pose::prior_world(1).trees, 1000.0);
  const std::string text = refusal();
  EXPECT_NE(text.find("not in metres"), std::string::npos) << text;
  EXPECT_NE(text.find("pose.prior_map.map_file"), std::string::npos) << text;
}

TEST_F(PriorMapNode, RefusesWhatIsNoMapWithTheLine) {
  std::ofstream(config_.pose.prior_map.map_file) << "class,x_m,y_m,width_m\ntree,1,2,0.1\n";
  EXPECT_NE(refusal().find("map.csv:1"), std::string::npos) << refusal();
}

TEST(PriorMapConfig, TheModeNeedsAMapFile) {
  EXPECT_THROW(io::parse_config("pose: {mode: prior_map}", "rig.yaml"), io::ConfigError);
  EXPECT_NO_THROW(
      io::parse_config("pose: {mode: prior_map, prior_map: {map_file: day1}}", "rig.yaml"));
}

}  // namespace
}  // namespace orchard::procs
