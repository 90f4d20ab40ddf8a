// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "bus/messages/codec.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

class Overlay : public CliTest {
 protected:
  Result overlay(const std::string& log_path, const std::string& at) const {
    return orchard(
        {"overlay", log_path, "--at", at, "--config", config(), "--out", path("overlay.png")});
  }
  void expect_refused(const Result& result, const std::string& why) const {
    EXPECT_EQ(result.exit_code, 3) << result.out;
    EXPECT_THAT(result.err, HasSubstr(why));
    EXPECT_LE(count_lines(result.err), 3) << result.err;  // at most with the key that differs
    EXPECT_FALSE(exists(path("overlay.png")));
  }
};

TEST_F(Overlay, DrawsThePairNearestToATime) {
  const Result result = overlay(log(), "3.4");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const cv::Mat drawn = cv::imread(path("overlay.png"));
  ASSERT_EQ(drawn.cols, 1280);  // 320 pixels four times
  EXPECT_GT(drawn.rows, 960);
  const std::string bytes = read_file(path("overlay.png"));
  // Stops are a second apart, so the third is meant; the same by its utime.
  ASSERT_EQ(overlay(log(), "1385942403000000").exit_code, 0);
  EXPECT_EQ(read_file(path("overlay.png")), bytes);
  ASSERT_EQ(overlay(log(), "5").exit_code, 0);
  EXPECT_NE(read_file(path("overlay.png")), bytes);
}

TEST_F(Overlay, SaysWhatIsWrong) {
  expect_refused(overlay(log(), "9999"), "give --at within it");
  expect_refused(overlay(log(), "-1"), "give --at within it");
  expect_refused(overlay(path("none.lcm"), "1"), "none.lcm");
  write_file(path("empty.lcm"), "");
  expect_refused(overlay(path("empty.lcm"), "1"), "empty.lcm");
  EXPECT_EQ(overlay(log(), "soon").exit_code, 2);

  io::LogWriter blind(path("blind.lcm")), early(path("early.lcm"));
  io::LogReader reader(log());
  int num_images = 0;
  while (const auto event = reader.next()) {
    const bool is_image = event->channel == bus::info(bus::Channel::kImage).name;
    if (!is_image) blind.write(event->timestamp_us, event->channel, event->data);
    if (is_image && ++num_images > 2) continue;
    early.write(event->timestamp_us, event->channel, event->data);
  }
  blind.close();
  early.close();
  expect_refused(overlay(path("blind.lcm"), "1"), "IMAGE");
  expect_refused(overlay(path("early.lcm"), "9"), "no pair of scan and picture");
}

TEST_F(Overlay, ARigOfAnotherCameraIsRefused) {
  std::string rig = read_file(config());
  const std::size_t at = rig.find("width_px: 320");
  ASSERT_NE(at, std::string::npos);
  rig.replace(at, 13, "width_px: 640");
  write_file(path("rig.yaml"), rig);
  expect_refused(orchard({"overlay", log(), "--at", "3", "--config", path("rig.yaml"), "--out",
                          path("overlay.png")}),
                 "320x240");
}

TEST_F(Overlay, ADelayNeedsADriveThatTurns) {
  const std::string before = read_file(config());
  const auto calibrate = [&](const std::string& log_path, const std::string& rig) {
    return orchard({"calibrate", "delay", log_path, "--config", rig, "--out", path("rig.yaml")});
  };
  const Result standing = calibrate(log(), config());
  EXPECT_EQ(standing.exit_code, 3);
  EXPECT_THAT(standing.err, HasSubstr("ODOMETRY"));
  EXPECT_EQ(count_lines(standing.err), 1) << standing.err;

  const std::string orchard_rig = ORCHARD_SOURCE_DIR "/config/orchard.yaml";
  ASSERT_EQ(orchard({"simulate", "--scene", "orchard", "--seed", "6", "--config", orchard_rig,
                     "--out", path("straight.lcm"), "--duration", "8"})
                .exit_code,
            0);
  const Result straight = calibrate(path("straight.lcm"), orchard_rig);
  EXPECT_EQ(straight.exit_code, 3);
  EXPECT_THAT(straight.err, HasSubstr("hardly turned"));
  EXPECT_EQ(count_lines(straight.err), 1) << straight.err;

  EXPECT_EQ(calibrate(path("none.lcm"), orchard_rig).exit_code, 3);
  EXPECT_FALSE(exists(path("rig.yaml")));
  EXPECT_EQ(read_file(config()), before);
}

}  // namespace
}  // namespace orchard::cli_test
