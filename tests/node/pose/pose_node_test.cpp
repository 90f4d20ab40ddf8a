// SPDX-License-Identifier: BSD-3-Clause
#include "pose/pose_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "pose/motion.hpp"
#include "unit/pose/prior_map/prior_world.hpp"
#include "unit/pose/scan_matching/cast_world.hpp"
#include "worlds/landmark.hpp"

namespace orchard::procs {
namespace {

io::Config config_of(pose::PoseMode mode) {
  io::Config config;
  config.pose.mode = mode;
  config.pose.reorder_window_s = 0.05;
  return config;
}

std::vector<pose::PoseEstimate> run(const io::Config& config,
                                    const std::vector<bus::Message>& inputs) {
  PoseNode node(config);
  std::vector<pose::PoseEstimate> poses;
  const bus::Outbox send = [&](bus::Message m) {
    if (const auto* pose = std::get_if<pose::PoseEstimate>(&m)) poses.push_back(*pose);
  };
  for (const bus::Message& input : inputs) node.handle(input, send);
  node.flush(send);
  return poses;
}

/// Odometry at 50 Hz and a fix per 200 ms of a robot that drives a straight line at 1 m/s.
std::vector<bus::Message> straight_drive() {
  std::vector<bus::Message> messages;
  for (int i = 0; i <= 100; ++i) {
    pose::Odometry odometry;
    odometry.utime = i * 20000;
    odometry.seq = i;
    odometry.speed_mps = 1.0;
    messages.emplace_back(odometry);
    if (i % 10 != 0) continue;
    pose::PoseFix fix;
    fix.utime = i * 20000;
    fix.seq = i / 10;
    fix.x_m = i * 0.020;
    messages.emplace_back(fix);
  }
  return messages;
}

/// Messages in order of their arrival, each delay_us(message) after its time.
template <class Delay>
std::vector<bus::Message> arriving(const std::vector<bus::Message>& messages,
                                   const Delay& delay_us) {
  std::vector<std::pair<std::int64_t, bus::Message>> arrivals;
  for (const bus::Message& m : messages) arrivals.emplace_back(bus::utime_of(m) + delay_us(m), m);
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<bus::Message> ordered;
  for (auto& arrival : arrivals) ordered.push_back(std::move(arrival.second));
  return ordered;
}

TEST(PoseNode, OnePosePerTimeInOrderAlongTheTrueLine) {
  const auto poses = run(config_of(pose::PoseMode::kFixesAndOdometry), straight_drive());
  ASSERT_EQ(poses.size(), 101u);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].seq, static_cast<std::int32_t>(i));
    EXPECT_NEAR(poses[i].x_m, poses[i].utime * 1e-6, 1e-9);
    EXPECT_NEAR(poses[i].yaw_rad, 0.0, 1e-9);
  }
}

TEST(PoseNode, ArrivalOrderBetweenChannelsDoesNotMatter) {
  const std::vector<bus::Message> messages = straight_drive();
  const auto reference = run(config_of(pose::PoseMode::kFixesAndOdometry), messages);
  std::mt19937_64 random(5);
  for (int round = 0; round < 20; ++round) {
    // fixes lag or lead odometry by up to 40 ms: less than the window
    const auto shuffled = arriving(messages, [&](const bus::Message& m) {
      const bool is_fix = std::holds_alternative<pose::PoseFix>(m);
      return is_fix ? static_cast<std::int64_t>(random() % 80001) - 40000 : 0;
    });
    const auto poses = run(config_of(pose::PoseMode::kFixesAndOdometry), shuffled);
    ASSERT_EQ(poses.size(), reference.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_EQ(poses[i].utime, reference[i].utime);
      EXPECT_EQ(poses[i].x_m, reference[i].x_m);
      EXPECT_EQ(poses[i].covariance, reference[i].covariance);
    }
  }
}

/// What a live process sends for messages in order of arrival, as bytes.
std::vector<bus::Output> heard(const io::Config& config, const std::vector<bus::Message>& inputs) {
  PoseNode node(config);
  std::vector<bus::Output> outputs;
  bus::NodeHost host(node, [&](bus::Output&& output) { outputs.push_back(std::move(output)); });
  for (const bus::Message& input : inputs) host.receive(input);
  host.flush();
  return outputs;
}

TEST(PoseNode, ClocksThatAreSetMoveNoRobotInWhateverOrderTheChannelsArrive) {
  constexpr std::int64_t kStart = 1'700'000'000'000'000, kSet = 1'000'000;
  const auto clean = run(config_of(pose::PoseMode::kFixesAndOdometry), straight_drive());
  std::mt19937_64 random(7);
  for (const std::int64_t step_us :
       {-86'400'000'000L, -7'200'000'000L, -60'000'000L, -4'000'000L, 3'600'000'000L}) {
    for (const bool restarts : {false, true}) {
      std::vector<std::vector<bus::Output>> all;
      for (int round = 0; round < 6; ++round) {
        std::vector<bus::Message> messages = arriving(straight_drive(), [&](const bus::Message& m) {
          const bool is_fix = std::holds_alternative<pose::PoseFix>(m) && round > 0;
          return is_fix ? static_cast<std::int64_t>(random() % 80001) - 40000 : 0;
        });
        for (bus::Message& message : messages) {
          std::visit(
              [&](auto& m) {
                const bool is_set = m.utime >= kSet;
                if (is_set && restarts)
                  m.seq -= std::is_same_v<decltype(m), pose::PoseFix&> ? 5 : 50;
                m.utime += kStart + (is_set ? step_us : 0);
              },
              message);
        }
        all.push_back(heard(config_of(pose::PoseMode::kFixesAndOdometry), messages));
        const std::string what = std::to_string(step_us) + " in round " + std::to_string(round);
        ASSERT_EQ(all.back().size(), clean.size()) << what;
        for (std::size_t i = 0; i < clean.size(); ++i) {
          const auto message = bus::decode(bus::Channel::kPose, all.back()[i].bytes.data(),
                                           all.back()[i].bytes.size());
          const auto& pose = std::get<pose::PoseEstimate>(std::get<bus::Message>(message));
          EXPECT_EQ(pose.utime, clean[i].utime + kStart + (clean[i].utime < kSet ? 0 : step_us));
          EXPECT_NEAR(pose.x_m, clean[i].x_m, step_us < 0 ? 1e-9 : 0.05) << what;
          EXPECT_EQ(all.back()[i].bytes, all.front()[i].bytes) << what << ", pose " << i;
        }
      }
    }
  }
}

TEST(PoseNode, SixForgedOnesOfTomorrowThatAgreeChangeNothing) {
  const std::vector<bus::Message> messages = straight_drive();
  const auto config = config_of(pose::PoseMode::kFixesAndOdometry);
  std::vector<bus::Message> attacked = messages;
  for (int i = 0; i < 6; ++i) {
    pose::Odometry forged;
    forged.utime = 86'400'000'000 + i * 20'000;
    forged.seq = 40 + i;
    forged.speed_mps = 1.0;
    attacked.insert(attacked.begin() + 44 + i, forged);
  }
  const auto clean = heard(config, messages), poses = heard(config, attacked);
  ASSERT_EQ(poses.size(), clean.size());
  for (std::size_t i = 0; i < clean.size(); ++i) EXPECT_EQ(poses[i].bytes, clean[i].bytes);
}

/// Ten metres to the east, and five fixes a second of a receiver: in order of time.
std::vector<bus::Message> drive_under_satellites() {
  std::vector<bus::Message> messages;
  for (int i = 0; i <= 500; ++i) {
    pose::Odometry odometry;
    odometry.utime = i * 20000;
    odometry.seq = i;
    odometry.speed_mps = 1.0;
    messages.emplace_back(odometry);
    if (i % 10 != 0) continue;
    pose::Gnss fix;
    fix.utime = i * 20000 + 3000;
    fix.seq = i / 10;
    fix.latitude_deg = -27.6;
    fix.longitude_deg = 151.9 + 0.02 * i / (111320.0 * std::cos(27.6 * 0.017453292519943295));
    fix.covariance = {4e-4, 0, 0, 4e-4, 0, 1e-3};
    fix.fix_quality = 4;
    messages.emplace_back(fix);
  }
  return messages;
}

TEST(PoseNode, FixesOfAReceiverThatTakesItsTimeAreUsedLikePunctualOnes) {
  io::Config config = config_of(pose::PoseMode::kFused);
  config.pose.reorder_window_s = 0.02;
  const std::vector<bus::Message> in_order = drive_under_satellites();
  const auto reference = run(config, in_order);
  ASSERT_GT(reference.size(), 400u);
  for (const std::int64_t latency_us : {50'000, 120'000, 250'000, 450'000}) {
    PoseNode node(config);
    std::vector<pose::PoseEstimate> poses;
    const bus::Outbox send = [&](bus::Message m) {
      if (const auto* pose = std::get_if<pose::PoseEstimate>(&m)) poses.push_back(*pose);
    };
    const auto late = arriving(in_order, [&](const bus::Message& m) {
      return std::holds_alternative<pose::Gnss>(m) ? latency_us : 0;
    });
    for (const bus::Message& message : late) node.handle(message, send);
    EXPECT_EQ(node.counts().num_late, 0) << latency_us;
    node.flush(send);
    ASSERT_EQ(poses.size(), reference.size()) << latency_us;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      ASSERT_EQ(poses[i].utime, reference[i].utime);
      ASSERT_EQ(poses[i].x_m, reference[i].x_m) << latency_us << " " << i;
    }
  }
}

/// Up a row of a cast orchard, with true wheels and the scans of a scanner 0.4 m ahead; a turn to
/// either side in between.
TEST(PoseNode, AScannerThatIsNotWhereTheRigSaysIsNamedAndMovesNoPose) {
  io::Config config = config_of(pose::PoseMode::kOdometry);
  config.laser.mount_x_m = 0.4;
  config.laser.mount_yaw_rad = 0.1;  // it looks ahead
  const pose::CastWorld world = pose::orchard_world();
  Eigen::Vector3d T_map_base(1.0, -4.0, 0.0);
  std::vector<bus::Message> wheels, all;
  for (int i = 0; i < 250; ++i) {
    pose::Odometry odometry;
    odometry.utime = i * 200'000;
    odometry.seq = i;
    odometry.speed_mps = 0.8;
    odometry.yaw_rate_radps = i % 80 < 50 ? 0.0 : (i / 80 % 2 == 0 ? 0.3 : -0.3);
    T_map_base = pose::compose(
        T_map_base,
        pose::arc_motion(odometry.speed_mps, odometry.yaw_rate_radps, i > 0 ? 0.2 : 0.0));
    wheels.emplace_back(odometry);
    all.emplace_back(odometry);
    laser::Scan scan =
        world.scan(odometry.utime, pose::compose(T_map_base, {0.4, 0.0, 0.0}), nullptr);
    scan.seq = i;
    all.emplace_back(scan);
  }
  EXPECT_EQ(run(config, all).size(), run(config, wheels).size());

  PoseNode node(config);
  for (const bus::Message& message : all) node.handle(message, [](const bus::Message&) {});
  node.flush([](const bus::Message&) {});
  ASSERT_EQ(node.findings().size(), 1u);
  EXPECT_EQ(node.findings()[0].name, "laser_yaw");
  EXPECT_NE(bus::warning_text(node).find("laser.mount_yaw_rad is 0.100"), std::string::npos);
  config.laser.mount_yaw_rad = 0.0;
  PoseNode right(config);
  for (const bus::Message& message : all) right.handle(message, [](const bus::Message&) {});
  right.flush([](const bus::Message&) {});
  EXPECT_TRUE(right.findings().empty());
}

TEST(PoseNode, AStationaryRobotIsAtTheOriginForEveryScan) {
  laser::Scan scan;
  scan.utime = 77;
  const auto poses = run(config_of(pose::PoseMode::kStationary), {scan});
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].utime, 77);
  EXPECT_EQ(poses[0].x_m, 0.0);
}

/// Truth: the rule of trajectory_t that a correction holds for POSE before its utime.
TEST(PoseNode, TheCorrectionAtTheEndHoldsForTheLastPose) {
  PoseNode node(config_of(pose::PoseMode::kSlam));
  std::int64_t last_pose_utime = 0, last_page_utime = 0;
  const bus::Outbox send = [&](bus::Message m) {
    if (const auto* pose = std::get_if<pose::PoseEstimate>(&m)) last_pose_utime = pose->utime;
    if (const auto* page = std::get_if<pose::TrajectoryPage>(&m)) last_page_utime = page->utime;
  };
  for (const bus::Message& input : straight_drive()) {
    node.handle(input, send);
    const auto* odometry = std::get_if<pose::Odometry>(&input);
    if (!odometry || odometry->seq % 10 != 0) continue;
    detection::Detections seen;
    seen.utime = odometry->utime;
    seen.seq = odometry->seq / 10;
    node.handle(seen, send);
  }
  node.flush(send);
  EXPECT_GT(last_pose_utime, 0);
  EXPECT_GT(last_page_utime, last_pose_utime);
}

TEST(PoseNode, SaysWhatItWaitsFor) {
  PoseNode node(config_of(pose::PoseMode::kFixesAndOdometry));
  pose::Odometry odometry;
  odometry.utime = 10;
  node.handle(odometry, [](bus::Message) {});
  EXPECT_NE(node.waiting_for().find("POSE_FIX"), std::string::npos);
}

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
      const Eigen::Vector2d p_map = factor * tree.p_map;
      landmarks.push_back(test::tree(static_cast<std::int32_t>(landmarks.size() + 1), p_map.x(),
                                     p_map.y(), tree.width_m, num_observations));
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
  const std::vector<bus::Channel> inputs = node.inputs();
  ASSERT_GE(inputs.size(), 2u);
  EXPECT_EQ(inputs[0], bus::Channel::kOdometry);
  EXPECT_EQ(inputs[1], bus::Channel::kDetections);
  for (std::size_t i = 2; i < inputs.size(); ++i) {  // they only check the rig
    EXPECT_EQ(node.need_of(inputs[i]), bus::InputNeed::kOccasional) << bus::info(inputs[i]).name;
  }
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

TEST_F(PriorMapNode, RefusesADamagedMapWithTheLine) {
  write_map({});
  std::ofstream(config_.pose.prior_map.map_file, std::ios::app) << "1,tree,here\n";
  EXPECT_NE(refusal().find("map.csv:2"), std::string::npos) << refusal();
}

TEST(PriorMapConfig, TheModeNeedsAMapFile) {
  EXPECT_THROW(io::parse_config("pose: {mode: prior_map}", "rig.yaml"), io::ConfigError);
  EXPECT_NO_THROW(
      io::parse_config("pose: {mode: prior_map, prior_map: {map_file: day1}}", "rig.yaml"));
}

}  // namespace
}  // namespace orchard::procs
