// SPDX-License-Identifier: BSD-3-Clause
// Sends SCAN at 10 Hz and ODOMETRY at 50 Hz from anything that measures. To build:
//   lcm-gen --cpp lcmtypes/scan_t.lcm lcmtypes/odometry_t.lcm
//   g++ -std=c++17 -I. send.cpp -llcm -o send
#include <chrono>
#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <thread>

#include "orchard/odometry_t.hpp"
#include "orchard/scan_t.hpp"

int main() {
  lcm::LCM lcm("udpm://239.255.76.67:7667?ttl=0");
  if (!lcm.good()) return 1;
  const auto now_us = [] {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  orchard::scan_t scan;  // a post of 10 cm, 2 m ahead; here the scanner's bytes would be read
  scan.seq = 0;
  scan.bearing_min_rad = -1.5;
  scan.bearing_step_rad = 0.01;
  scan.beam_period_us = 0.0;  // unknown
  scan.range_min_m = 0.1;
  scan.range_max_m = 30.0;
  scan.num_ranges = 301;
  scan.ranges_m.assign(301, 0.0f);  // 0: no return
  for (int i = 148; i <= 152; ++i) scan.ranges_m[i] = 1.95f + 0.01f * std::abs(i - 150);
  scan.num_intensities = 0;
  orchard::odometry_t odometry{};  // its covariance: 0, unknown
  for (int i = 0;; ++i) {
    odometry.utime = now_us();  // when it was measured, not when it is sent
    odometry.seq = i;           // +1 per message: gaps are counted as lost
    odometry.speed_mps = 0.5;
    odometry.yaw_rate_radps = 0.0;
    lcm.publish("ODOMETRY", &odometry);
    if (i % 5 == 0) {
      scan.utime = now_us();  // of the first beam
      lcm.publish("SCAN", &scan);
      ++scan.seq;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}
