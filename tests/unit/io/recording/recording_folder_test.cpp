// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "geometry/angles.hpp"
#include "io/file_error.hpp"
#include "io/recording/recording_folder.hpp"
#include "unit/io/test_folder.hpp"
#include "worlds/observation_csv.hpp"

namespace orchard::io {
namespace {

using simulation::TrueObservation;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr char kSensors[] =
    "laser:\n  num_beams: 2\n  bearing_min_rad: -0.1\n  bearing_step_rad: 0.2\n"
    "  range_min_m: 0.1\n  range_max_m: 5\n  mount: {x_m: 0.3, y_m: 0, yaw_rad: 0}\n";
constexpr char kScans[] = "utime_us,range_0_m,range_1_m\n100,0,1.5\n200,7.25,2\n";

void write_recording(const TestFolder& folder) {
  write_bytes(folder / "sensors.yaml", kSensors);
  write_bytes(folder / "scans.csv", kScans);
  write_bytes(folder / "poses.csv", "utime_us,x_m,y_m,yaw_rad\n100,1,2,3.5\n");
  write_bytes(folder / "odometry.csv", "utime_us,v_mps,yaw_rate_radps\n50,0.5,-0.1\n150,0.6,0\n");
}

std::string error_of(const std::string& path) {
  return refusal_of([&] { read_recording_folder(path); });
}

TEST(RecordingFolder, MessagesComeInOrderOfTimeAndKind) {
  const TestFolder folder;
  write_recording(folder);
  const auto messages = read_recording_folder(folder.path());
  ASSERT_THAT(messages, SizeIs(5));
  EXPECT_EQ(std::get<pose::Odometry>(messages[0]).speed_mps, 0.5);
  const auto& scan = std::get<laser::Scan>(messages[1]);
  EXPECT_EQ(scan.utime, 100);
  EXPECT_EQ(scan.ranges_m, (std::vector<float>{0.0f, 1.5f}));
  EXPECT_EQ(scan.bearing_step_rad, 0.2);
  EXPECT_NEAR(std::get<pose::PoseFix>(messages[2]).yaw_rad, 3.5 - 2 * geometry::kPi, 1e-12);
  EXPECT_EQ(std::get<pose::Odometry>(messages[3]).seq, 1);
  EXPECT_EQ(std::get<laser::Scan>(messages[4]).ranges_m[0], 7.25f) << "beyond range_max stays";
  EXPECT_EQ(RecordingFolder(folder.path()).laser().mount.x_m, 0.3);
}

TEST(RecordingFolder, AHeadThatTurnsAgainstTheColumnsMeasuresTheLastFirst) {
  const TestFolder folder;
  write_recording(folder);
  write_bytes(folder / "sensors.yaml", std::string(kSensors) + "  beam_period_us: -90\n");
  write_bytes(folder / "intensities.csv", "utime_us,a,b\n100,3,4\n200,5,6\n");
  const auto messages = read_recording_folder(folder.path());
  const auto& scan = std::get<laser::Scan>(messages[1]);
  EXPECT_EQ(scan.utime, 100);
  EXPECT_EQ(scan.ranges_m, (std::vector<float>{1.5f, 0.0f}));
  EXPECT_DOUBLE_EQ(scan.bearing_rad(0), 0.1) << "the last column's";
  EXPECT_DOUBLE_EQ(scan.bearing_rad(1), -0.1);
  EXPECT_EQ(scan.beam_period_us, 90.0);
}

TEST(RecordingFolder, MistakesAreNamedWithFileAndLine) {
  const TestFolder folder;
  EXPECT_THAT(error_of(folder / "none"), HasSubstr("is not a folder"));
  EXPECT_THAT(error_of(folder.path()), HasSubstr("sensors.yaml"));
  write_recording(folder);
  write_bytes(folder / "sensors.yaml", std::string(kSensors) + "  colour: red\n");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("sensors.yaml:8: laser.colour: unknown key"));
  write_bytes(folder / "sensors.yaml", kSensors);
  const std::pair<const char*, const char*> cases[] = {
      {"utime_us,a,b\n100,0,1\n100,0,1\n", "scans.csv:3:1: utime_us: 100 is not later than"},
      {"utime_us,a,b\n100,0\n", "scans.csv:2:1: 2 fields"},
      {"utime_us,a,b\n100,0,nan\n", "scans.csv:2:7: b: \"nan\" is not a finite number"},
      {"utime_us,a,b\n100,0,-1\n", "scans.csv:2:7: b: \"-1\" must be in"},
      {"utime_us,a,b\n100,,1\n", "scans.csv:2:5: a: \"\" is not a finite number"},
      {"utime_us,a,b\n\n", "scans.csv:2:1: an empty line"},
      {"utime_us,a\n100,0\n", "scans.csv:1:1: 1 columns after utime_us, but sensors.yaml says"},
      {"", "scans.csv is empty"}};
  for (const auto& [text, error] : cases) {
    write_bytes(folder / "scans.csv", text);
    EXPECT_THAT(error_of(folder.path()), HasSubstr(error));
  }
  write_bytes(folder / "scans.csv", kScans);
  std::filesystem::create_directory(folder / "images");
  write_bytes(folder / "images/100.jpg", "no picture");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("100.jpg: is not a JPEG"));
}

TEST(RecordingFolder, ACompressedFileThatIsCutOrFlippedIsRefused) {
  const TestFolder folder;
  write_recording(folder);
  std::filesystem::remove(folder / "scans.csv");
  const gzFile file = gzopen((folder / "scans.csv.gz").c_str(), "wb");
  gzwrite(file, kScans, sizeof(kScans) - 1);
  gzclose(file);
  EXPECT_THAT(read_recording_folder(folder.path()), SizeIs(5));
  const std::string good = read_bytes(folder / "scans.csv.gz");
  write_bytes(folder / "scans.csv.gz", good.substr(0, good.size() - 9));
  EXPECT_THAT(error_of(folder.path()), HasSubstr("damaged or truncated"));
  std::string bad = good;
  bad[good.size() - 6] = static_cast<char>(bad[good.size() - 6] ^ 1);  // in the check sum
  write_bytes(folder / "scans.csv.gz", bad);
  EXPECT_THAT(error_of(folder.path()), HasSubstr("damaged or truncated"));
}

TEST(RecordingFolder, TheRealOnesAreRead) {
  const std::string data = ORCHARD_DATA_DIR;
  if (!std::filesystem::exists(data + "/pullally_drive_1")) {
    GTEST_SKIP() << "no recordings in " << data;
  }
  const auto messages = read_recording_folder(data + "/pullally_drive_1");
  EXPECT_THAT(messages, SizeIs(3 * 546));
  EXPECT_THAT(std::get<laser::Scan>(messages[0]).ranges_m, SizeIs(897));
  EXPECT_THAT(read_recording_folder(data + "/koala_poles"), SizeIs(3349 + 3348));
  EXPECT_THAT(read_recording_folder(data + "/urg_geometry_front"), SizeIs(331));
  EXPECT_THAT(read_recording_folder(data + "/urg_geometry_rear"), SizeIs(330));
}

const std::string kHeader =
    "utime_us,object,class,x_m,y_m,width_m,range_m,bearing_rad,num_beams,hidden_fraction,"
    "in_picture\n";

TEST(ObservationCsv, ReadsWhatItWrites) {
  TrueObservation tree;
  tree.utime = 1385942400100000;
  tree.object = 7;
  tree.x_m = -1.25;
  tree.y_m = 12.5;
  tree.width_m = 0.125;
  tree.range_m = 3.5;
  tree.bearing_rad = -0.25;
  tree.num_beams = 9;
  tree.hidden_fraction = 0.375;
  tree.in_picture = true;
  TrueObservation crate = tree;
  crate.object = 30;
  crate.label = detection::Label::kObject;
  crate.in_picture = false;
  TestFolder folder;
  write_observation_csv(folder / "o.csv", {tree, crate});
  const auto read = read_observation_csv(folder / "o.csv");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].utime, tree.utime);
  EXPECT_EQ(read[1].label, detection::Label::kObject);
  EXPECT_FALSE(read[1].in_picture);
  write_observation_csv(folder / "again.csv", read);
  EXPECT_EQ(read_bytes(folder / "again.csv"), read_bytes(folder / "o.csv"));
  EXPECT_THAT(
      read_bytes(folder / "o.csv"),
      HasSubstr("\n1385942400100000,7,tree,-1.2500,12.5000,0.1250,3.5000,-0.25000,9,0.375,1\n"));
}

TEST(ObservationCsv, RefusesWhatCannotBeAndSaysWhere) {
  const TestFolder folder;
  const std::string good = "100,0,tree,1,2,0.1,3,0.5,4,0.25,1\n";
  EXPECT_EQ(read_observation_csv(folder.file("a.csv", kHeader + good)).size(), 1u);
  const struct {
    std::string row, message;
  } cases[] = {
      {"99,1,tree,1,2,0.1,3,0.5,4,0.25,1\n", "a.csv:3:1: "},      // back in time
      {"100,0,tree,1,2,0.1,3,0.5,4,0.25,1\n", "twice"},           // in one scan
      {"200,0,object,1,2,0.1,3,0.5,4,0.25,1\n", "class"},         // changes its class
      {"200,-1,tree,1,2,0.1,3,0.5,4,0.25,1\n", "a.csv:3:5: "},    // no object
      {"200,1,bush,1,2,0.1,3,0.5,4,0.25,1\n", "tree or object"},  // no class
      {"200,1,tree,nan,2,0.1,3,0.5,4,0.25,1\n", "a.csv:3:"},      // no number
      {"200,1,tree,1,2,-0.1,3,0.5,4,0.25,1\n", "a.csv:3:"},       // width
      {"200,1,tree,1,2,0.1,3,50,4,0.25,1\n", "a.csv:3:"},         // bearing in degrees
      {"200,1,tree,1,2,0.1,3,0.5,4.5,0.25,1\n", "a.csv:3:"},      // half a beam
      {"200,1,tree,1,2,0.1,3,0.5,4,1.25,1\n", "a.csv:3:"},        // more than all of it
      {"200,1,tree,1,2,0.1,3,0.5,4,0.25,2\n", "a.csv:3:"},        // neither
      {"200,1,tree,1,2,0.1,3,0.5,4,0.25\n", "a.csv:3"},           // a field less
  };
  for (const auto& c : cases) {
    const std::string path = folder.file("a.csv", kHeader + good + c.row);
    const std::string refusal = refusal_of([&] { read_observation_csv(path); });
    EXPECT_THAT(refusal, HasSubstr(c.message)) << c.row;
    EXPECT_THAT(refusal, HasSubstr("a.csv:3")) << c.row;
  }
  EXPECT_THROW(read_observation_csv(folder.file("a.csv", "utime_us,object\n1,2\n")), FileError);
  EXPECT_THROW(read_observation_csv("/no/such/file.csv"), FileError);
}

}  // namespace
}  // namespace orchard::io
