// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>

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

TEST_F(ImportCommand, ARealRecording) {
  const std::string recording = ORCHARD_DATA_DIR "/koala_poles";
  if (!exists(recording)) GTEST_SKIP() << "the recording koala_poles is not here";
  ASSERT_EQ(orchard({"import", recording, "--out", path("koala.lcm")}).exit_code, 0);
  EXPECT_EQ(num_messages(path("koala.lcm"), "SCAN"), 3349);  // as its description says
}

}  // namespace
}  // namespace orchard::cli_test
