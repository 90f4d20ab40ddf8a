// SPDX-License-Identifier: BSD-3-Clause
// Tells how far a drive that ends where it began is from closing, by its scans alone.
#include <cstdio>
#include <exception>
#include <string>

#include "io/config/config.hpp"
#include "io/map/map_csv.hpp"
#include "io/recording/recording_folder.hpp"
#include "system/real_recordings/return_consistency.hpp"

namespace {

constexpr double kWindow_s = 30.0;

void print(const char* what, const std::optional<orchard::test::ReturnConsistency>& found) {
  if (!found) {
    std::printf("return by %s: the last scans lie nowhere near upon the first\n", what);
    return;
  }
  std::printf("return by %s: the last scans lie %.2f m and %.1f degrees from the first\n", what,
              found->shift_m, found->turn_rad * 180.0 / 3.14159265358979);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: return_trip RECORDING_FOLDER MAP_FOLDER RIG.yaml\n");
    return 2;
  }
  try {
    const auto recording = orchard::io::read_recording_folder(argv[1]);
    const auto mount = orchard::io::load_config(argv[3]).laser;
    const auto path = orchard::io::read_trajectory_csv(std::string(argv[2]) + "/trajectory.csv");
    using namespace orchard::test;
    print("the map's path", return_consistency(recording, path, mount, kWindow_s));
    print("the wheels alone",
          return_consistency(recording, dead_reckoned(recording), mount, kWindow_s));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "return_trip: %s\n", error.what());
    return 3;
  }
}
