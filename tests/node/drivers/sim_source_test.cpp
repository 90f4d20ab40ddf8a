// SPDX-License-Identifier: BSD-3-Clause
#include "sim_driver/sim_source.hpp"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <variant>

#include "bus/messages/codec.hpp"
#include "io/map/map_csv.hpp"
#include "io/recording/truth_csv.hpp"

namespace orchard::procs {
namespace {

io::Config rig(const std::string& name) {
  return io::load_config(std::string(ORCHARD_SOURCE_DIR) + "/config/" + name);
}

// Whatever is simulated passes the guard that stands before every node, and comes out as it was.
TEST(SimSource, EveryMessagePassesTheGuard) {
  for (const std::string scene : {"tubes", "orchard"}) {
    io::Config config = rig(scene + ".yaml");
    config.simulation.orchard.trees_per_row = 3;
    SimDriverOptions options;
    options.scene = scene;
    options.seed = "3";
    const auto source = make_sim_source(options, config);
    std::array<int, bus::kNumChannels> counts{};
    std::int64_t last_utime = 0;
    while (const auto message = source->next()) {
      const bus::Channel channel = bus::channel_of(*message);
      const auto bytes = bus::encode(*message);
      const auto decoded = bus::decode(channel, bytes.data(), bytes.size());
      if (const auto* rejection = std::get_if<bus::Rejection>(&decoded)) {
        FAIL() << bus::to_string(rejection->reason) << ": " << rejection->detail;
      }
      EXPECT_EQ(bus::encode(std::get<bus::Message>(decoded)), bytes);
      EXPECT_LT(bytes.size(), 60000u);
      EXPECT_GE(bus::utime_of(*message), last_utime);
      last_utime = bus::utime_of(*message);
      ++counts[static_cast<std::size_t>(channel)];
    }
    EXPECT_GT(counts[static_cast<std::size_t>(bus::Channel::kScan)], 10);
    EXPECT_GT(counts[static_cast<std::size_t>(bus::Channel::kImage)], 10);
    EXPECT_GT(counts[static_cast<std::size_t>(bus::Channel::kPoseFix)], 10);
    EXPECT_EQ(counts[static_cast<std::size_t>(bus::Channel::kOdometry)] > 0, scene == "orchard");
    EXPECT_EQ(counts[static_cast<std::size_t>(bus::Channel::kGnss)] > 0, scene == "orchard");
  }
}

TEST(SimSource, WritesTheTruthItPlays) {
  SimDriverOptions options;
  options.truth_path = testing::TempDir() + "sim_source_truth.csv";
  options.poses_path = testing::TempDir() + "sim_source_poses.csv";
  const auto source = make_sim_source(options, rig("tubes.yaml"));
  const auto truth = io::read_truth_csv(options.truth_path);
  ASSERT_EQ(truth.size(), 16u);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(truth[i].name, source->simulator().truth()[i].name);
    EXPECT_NEAR(truth[i].x_m, source->simulator().truth()[i].x_m, 1e-4);
    EXPECT_NEAR(truth[i].y_m, source->simulator().truth()[i].y_m, 1e-4);
  }
  EXPECT_EQ(io::read_trajectory_csv(options.poses_path).size(),
            source->simulator().scene().stops.size());
}

TEST(SimSource, RefusesScenesAndSeedsThatAreNone) {
  SimDriverOptions options;
  options.scene = "forest";
  EXPECT_THROW(make_sim_source(options, {}), std::invalid_argument);
  options.scene = "tubes";
  for (const char* seed : {"", "-1", "1.5", "one", "99999999999999999999999"}) {
    options.seed = seed;
    EXPECT_THROW(make_sim_source(options, {}), std::invalid_argument) << seed;
  }
}

}  // namespace
}  // namespace orchard::procs
