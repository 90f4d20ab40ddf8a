// SPDX-License-Identifier: BSD-3-Clause
// make_golden_log FILE: wrote tests/data/golden_3.lcm, a log with messages of the newest types.
// Values are chosen by hand; tests/data/golden_3.txt states them, and golden_log_test reads both.
// (golden.lcm and golden_2.lcm were written by earlier forms of this.)
#include <cstdio>
#include <exception>
#include <string>

#include "bus/messages/codec.hpp"
#include "io/log/log_writer.hpp"

namespace orchard::bus {
namespace {

constexpr std::int64_t kStart = 1700000000000000;

/// Every message of the log comes a millisecond after the one before.
class Golden {
 public:
  explicit Golden(const std::string& path) : writer_(path) {}
  std::int64_t next_utime() { return utime_ += 1000; }
  void add(const Message& message) {
    writer_.write(utime_, info(channel_of(message)).name, encode(message));
  }
  void close() { writer_.close(); }

 private:
  io::LogWriter writer_;
  std::int64_t utime_ = kStart - 1000;
};

void add_imu(Golden& golden) {
  pose::Imu imu;
  imu.utime = golden.next_utime();
  imu.seq = 7;
  imu.angular_rate_radps = {0.125, -0.25, 0.5};
  imu.acceleration_mps2 = {0.75, -0.5, 9.75};
  imu.angular_rate_variance = 0.0078125;
  imu.acceleration_variance = 0.0625;
  imu.roll_rad = 0.03125;
  imu.pitch_rad = -0.0625;
  imu.yaw_rad = 1.5;
  imu.orientation_variance = 0.00390625;
  imu.has_orientation = true;
  golden.add(imu);
}

void add_trajectory(Golden& golden) {
  pose::TrajectoryPage page;
  page.utime = golden.next_utime();
  page.seq = 5;
  page.revision = 2;
  page.page = 1;
  page.num_pages = 3;
  page.poses.resize(2);
  page.poses[0].utime = kStart + 10;
  page.poses[1].utime = kStart + 20;
  page.poses[1].x_m = 12.5;
  page.poses[1].y_m = -3.75;
  page.poses[1].yaw_rad = -2.5;
  page.poses[1].covariance = {0.5, 0.25, 0.125, 1, 0.0625, 0.03125};
  golden.add(page);
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
    add_imu(golden);
    add_trajectory(golden);
    golden.close();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_golden_log: %s\n", error.what());
    return 1;
  }
}
