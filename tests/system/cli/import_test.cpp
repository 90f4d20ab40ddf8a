// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "io/map/map_csv.hpp"
#include "io/recording/truth_csv.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

class ImportCommand : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    std::filesystem::create_directory(path("drive"));
    write_file(path("drive/sensors.yaml"),
               "laser:\n  num_beams: 3\n  bearing_min_rad: -0.1\n  bearing_step_rad: 0.1\n"
               "  range_min_m: 0.1\n  range_max_m: 5\n"
               "  mount: {x_m: 0.25, y_m: 0, yaw_rad: 0}\n");
    write_file(path("drive/scans.csv"), "utime_us,r0,r1,r2\n1000000,1,2,0\n1100000,1,2,3\n");
    write_file(path("drive/poses.csv"), "utime_us,x_m,y_m,yaw_rad\n1000000,0,0,0\n");
  }
  Result import() const { return orchard({"import", path("drive"), "--out", path("drive.lcm")}); }
};

TEST_F(ImportCommand, AFolderBecomesALog) {
  const Result result = import();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 messages"));
  EXPECT_THAT(result.out, HasSubstr("mount_x_m: 0.25"));
  EXPECT_EQ(num_messages(path("drive.lcm"), "SCAN"), 2);
  EXPECT_EQ(num_messages(path("drive.lcm"), "POSE_FIX"), 1);
  EXPECT_EQ(orchard({"log", "check", path("drive.lcm")}).exit_code, 0);
}

TEST_F(ImportCommand, MistakesAreNamedAndNoLogIsLeft) {
  write_file(path("drive/scans.csv"), "utime_us,r0,r1,r2\n1000000,1,2,0\n1100000,1,two,3\n");
  const Result result = import();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("scans.csv:3"));
  EXPECT_EQ(count_lines(result.err), 1) << result.err;
  EXPECT_FALSE(exists(path("drive.lcm")));
}

TEST_F(ImportCommand, WhatIsNeitherFolderNorRawlogIsRefused) {
  write_file(path("noise.rawlog"), std::string(3000, 'x'));
  for (const char* name : {"noise.rawlog", "none.rawlog"}) {
    const Result result = orchard({"import", path(name), "--out", path("drive.lcm")});
    EXPECT_EQ(result.exit_code, 3) << name;
    EXPECT_THAT(result.err, HasSubstr(name));
    EXPECT_FALSE(exists(path("drive.lcm")));
  }
}

// Eight seconds of the simulated orchard (tests/data/make_row.sh), so that no checkout is without a
// recording: every trunk that the robot passed or came near is on the map, once, where it stands.
TEST_F(ImportCommand, TheRowOfThisRepositoryIsImportedAndMapped) {
  const std::string row = ORCHARD_SOURCE_DIR "/tests/data/row";
  ASSERT_EQ(orchard({"import", row, "--out", path("row.lcm")}).exit_code, 0);
  EXPECT_EQ(num_messages(path("row.lcm"), "SCAN"), 21);
  EXPECT_EQ(num_messages(path("row.lcm"), "IMAGE"), 10);
  EXPECT_EQ(num_messages(path("row.lcm"), "ODOMETRY"), 401);
  EXPECT_EQ(num_messages(path("row.lcm"), "POSE_FIX"), 81);
  const Result result = orchard({"map", path("row.lcm"), "--config",
                                 ORCHARD_SOURCE_DIR "/config/orchard.yaml", "--out", path("map")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto landmarks = io::read_map_csv(path("map/map.csv"));
  int num_judged = 0;
  for (const simulation::TruthObject& thing : io::read_truth_csv(row + "/truth.csv")) {
    if (thing.label != detection::Label::kTree || thing.y_m > 12.5) continue;
    int num_there = 0;
    for (const mapping::Landmark& l : landmarks) {
      if (std::hypot(l.x_m - thing.x_m, l.y_m - thing.y_m) > 0.05) continue;
      ++num_there;
      EXPECT_NEAR(l.width_m, thing.width_m, 0.015) << thing.x_m << ' ' << thing.y_m;
      EXPECT_NE(l.label, detection::Label::kObject) << thing.x_m << ' ' << thing.y_m;
    }
    EXPECT_EQ(num_there, 1) << thing.x_m << ' ' << thing.y_m;
    ++num_judged;
  }
  EXPECT_EQ(num_judged, 9);
}

TEST_F(ImportCommand, ARealRecording) {
  const std::string recording = ORCHARD_DATA_DIR "/koala_poles";
  if (!exists(recording)) GTEST_SKIP() << "the recording koala_poles is not here";
  ASSERT_EQ(orchard({"import", recording, "--out", path("koala.lcm")}).exit_code, 0);
  EXPECT_EQ(num_messages(path("koala.lcm"), "SCAN"), 3349);  // as its description says
}

}  // namespace
}  // namespace orchard::cli_test
