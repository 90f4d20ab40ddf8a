// SPDX-License-Identifier: BSD-3-Clause
// make_golden_log FILE: wrote tests/data/golden.lcm, a log with messages of every type. Values
// are chosen by hand; tests/data/golden.txt states them, and golden_log_test reads both.
#include <cstdio>
#include <exception>
#include <string>

#include "bus/codec.hpp"
#include "bus/service_messages.hpp"
#include "io/log_writer.hpp"

namespace orchard::bus {
namespace {

constexpr std::int64_t kStart = 1700000000000000;

/// Every message of the log comes a millisecond after the one before.
class Golden {
 public:
  explicit Golden(const std::string& path) : writer_(path) {}
  std::int64_t next_utime() { return utime_ += 1000; }
  void add(const Message& message) { add(channel_of(message), encode(message)); }
  void add(Channel channel, const std::vector<std::uint8_t>& bytes) {
    writer_.write(utime_, info(channel).name, bytes);
  }
  void close() { writer_.close(); }

 private:
  io::LogWriter writer_;
  std::int64_t utime_ = kStart - 1000;
};

void add_sources(Golden& golden) {
  laser::Scan scan;
  scan.bearing_min_rad = -2.25;
  scan.bearing_step_rad = 0.5;
  scan.beam_period_us = 97.5;
  scan.range_min_m = 0.0625;
  scan.range_max_m = 5.5;
  scan.ranges_m = {0.0f, 1.25f, 2.5f, 3.75f};
  for (scan.seq = 0; scan.seq < 2; ++scan.seq) {
    scan.utime = golden.next_utime();
    golden.add(scan);
    scan.intensities = {0.0f, 100.0f, 200.5f, 4095.0f};
  }

  vision::Image gray;
  gray.utime = golden.next_utime();
  gray.width_px = 4;
  gray.height_px = 3;
  gray.encoding = vision::Encoding::kGray8;
  gray.data = {0, 20, 40, 60, 80, 100, 120, 140, 160, 180, 200, 255};
  golden.add(gray);
  vision::Image jpeg;  // its head up to the frame header: what the guard reads of a JPEG
  jpeg.utime = golden.next_utime();
  jpeg.seq = 1;
  jpeg.width_px = 320;
  jpeg.height_px = 240;
  jpeg.data = {0xFF, 0xD8, 0xFF, 0xC0, 0, 17,   8, 0, 240,  1, 64,
               3,    1,    0x22, 0,    2, 0x11, 1, 3, 0x11, 1};
  golden.add(jpeg);

  pose::Odometry odometry;
  odometry.utime = golden.next_utime();
  odometry.speed_mps = 0.75;
  odometry.yaw_rate_radps = -0.125;
  odometry.covariance = {0.25, 0.0625, 0.5};
  golden.add(odometry);

  pose::Gnss gnss;
  gnss.utime = golden.next_utime();
  gnss.latitude_deg = -32.5;
  gnss.longitude_deg = -71.25;
  gnss.altitude_m = 42.5;
  gnss.covariance = {1, 0.5, 0.25, 2, 0.125, 3};
  gnss.fix_quality = 4;
  golden.add(gnss);

  pose::PoseFix fix;
  fix.utime = golden.next_utime();
  fix.x_m = 12.5;
  fix.y_m = -3.25;
  fix.yaw_rad = 1.5;
  fix.covariance = {1, 0.5, 0.25, 2, 0.125, 3};
  fix.has_yaw = true;
  golden.add(fix);
}

void add_derived(Golden& golden) {
  pose::PoseEstimate pose;
  pose.utime = golden.next_utime();
  pose.x_m = 1.5;
  pose.y_m = 2.5;
  pose.yaw_rad = -3;
  pose.pitch_rad = 0.25;
  pose.roll_rad = -0.25;
  pose.covariance = {1, 0.5, 0.25, 2, 0.125, 3};
  golden.add(pose);

  detection::Detection trunk;
  trunk.utime = kStart + 5;
  trunk.range_m = 2;
  trunk.bearing_rad = 0.25;
  trunk.surface_x_m = 1.875;
  trunk.surface_y_m = 0.625;
  trunk.centre_x_m = 1.9375;
  trunk.centre_y_m = 0.65625;
  trunk.covariance = {0.25, 0.0625, 0.5};
  trunk.width_m = 0.09375;
  trunk.width_sd_m = 0.0078125;
  trunk.roc_laser = 0.875f;
  trunk.roc_colour = 0.75f;
  trunk.roc_left_edge = 0.625f;
  trunk.roc_right_edge = 0.5f;
  trunk.roc_parallel = 0.375f;
  trunk.roc_edges = 0.25f;
  trunk.roc_vision = 0.125f;
  trunk.roc_tree = 0.9375f;
  trunk.num_beams = 9;
  trunk.label = detection::Label::kTree;
  trunk.occlusion = detection::kOccludedLeft;
  detection::Detections detections;
  detections.utime = golden.next_utime();
  detections.image_utime = kStart + 2;
  detections.trunks = {trunk, trunk};
  detections.trunks[1].label = detection::Label::kUnseen;
  golden.add(detections);

  mapping::Landmark landmark;
  landmark.id = 7;
  landmark.label = detection::Label::kObject;
  landmark.num_observations = 4;
  landmark.x_m = 3.5;
  landmark.y_m = 4.5;
  landmark.se_x_m = 0.00390625;
  landmark.se_y_m = 0.0078125;
  landmark.covariance = {0.25, 0.0625, 0.5};
  landmark.width_m = 0.171875;
  landmark.roc_mean = 0.3125;
  landmark.probability = 0.1875;
  landmark.row = 1;
  landmark.position = 5;
  mapping::MapTile tile;
  tile.utime = golden.next_utime();
  tile.num_landmarks_total = 12;
  tile.landmarks = {landmark};
  tile.removed_ids = {3, 4};
  golden.add(tile);
}

void add_services(Golden& golden) {
  Status status;
  status.utime = golden.next_utime();
  status.seq = 5;
  status.level = Level::kWarning;
  status.num_good = 10;
  status.num_bad = 11;
  status.num_lost = 12;
  status.num_late = 13;
  status.num_duplicate = 14;
  status.num_published = 15;
  status.input_period_s = 0.125;
  status.latency_mean_s = 0.0625;
  status.latency_max_s = 0.25;
  status.name = "orchard-detector";
  status.host = "robot";
  status.text = "waits";
  golden.add(Channel::kStatus, encode(status));
  const ConfigNotice notice{golden.next_utime(), 6,       0x0123456789abcdef,
                            "orchard-pose",      "0.1.0", "pose:\n  mode: fixes\n"};
  golden.add(Channel::kConfig, encode(notice));
  const Ack ack{
      golden.next_utime(), 8, 2, Channel::kDetections, {{Channel::kMap, 9}, {Channel::kMap, 10}}};
  golden.add(Channel::kAck, encode(ack));
  golden.add(Channel::kReplay, encode(ReplayMark{golden.next_utime(), 0, false}));
  golden.add(Channel::kReplay, encode(ReplayMark{golden.next_utime(), 3, true}));
}

}  // namespace
}  // namespace orchard::bus

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_golden_log FILE\n");
    return 2;
  }
  try {
    orchard::bus::Golden golden(argv[1]);
    add_sources(golden);
    add_derived(golden);
    add_services(golden);
    golden.close();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_golden_log: %s\n", error.what());
    return 1;
  }
}
