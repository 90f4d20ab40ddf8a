// SPDX-License-Identifier: BSD-3-Clause
// live_day [HOURS]: what a viewer keeps of a long drive, with somebody who looks on all the time
// and somebody who never comes back: its memory after each hour, at 10 scans and 2 pictures a
// second.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "view/live_state.hpp"

namespace {

using namespace orchard;

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  long size = 0, resident = 0;
  file >> size >> resident;
  return static_cast<double>(resident * sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace

int main(int argc, char** argv) {
  const int num_hours = argc > 1 ? std::atoi(argv[1]) : 24;
  constexpr int kScansPerHour = 36000;
  detection::Rig rig{laser::LaserConfig{}, geometry::CameraConfig{}, detection::DetectorConfig{}};
  view::LiveState state(rig, 2);
  view::ViewerProgress seen, lost;
  bool is_more = false;
  state.events_for(lost, is_more);
  std::size_t num_bytes = 0;
  for (int k = 0; k < num_hours * kScansPerHour; ++k) {
    const std::int64_t utime = std::int64_t{100000} * k;
    const double along_m = 0.05 * k;  // half a metre per second, rows of 200 m, 5 m apart
    const double row = std::floor(along_m / 200.0), x_m = std::fmod(along_m, 200.0);
    laser::Scan scan;
    scan.utime = utime;
    scan.bearing_step_rad = 0.02;
    scan.range_max_m = 30.0;
    scan.ranges_m.assign(180, 3.0f);
    state.take(scan);
    pose::PoseEstimate pose;
    pose.utime = utime;
    pose.x_m = x_m;
    pose.y_m = 5.0 * row;
    state.take(pose);
    mapping::MapTile tile;
    tile.utime = utime;
    for (int side = 0; side < 2; ++side) {  // a tree every 3 m on both sides
      mapping::Landmark tree;
      tree.id = 2 * static_cast<int>(along_m / 3.0) + side + 1;
      tree.x_m = 3.0 * std::floor(x_m / 3.0);
      tree.y_m = 5.0 * row + (side == 0 ? 2.5 : -2.5);
      tree.num_observations = 3 + k % 60;
      tile.landmarks.push_back(tree);
    }
    state.take(tile);
    if (k % 5 == 0) {
      vision::Image image;
      image.utime = utime;
      image.data.assign(12000, 7);
      state.take(image);
      detection::Detections detections;
      detections.utime = detections.image_utime = utime;
      state.take(detections);
    }
    if (k % 2 == 0) {
      for (const std::string& event : state.events_for(seen, is_more)) num_bytes += event.size();
    }
    if ((k + 1) % kScansPerHour == 0) {
      std::printf("%2d h: %6.1f MB, %zu trees, %.0f MB told\n", (k + 1) / kScansPerHour,
                  resident_mb(), state.landmarks().size(), 1e-6 * static_cast<double>(num_bytes));
      std::fflush(stdout);
    }
  }
}
