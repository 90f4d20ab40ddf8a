// SPDX-License-Identifier: BSD-3-Clause
// Maps five scans of five posts with the installed library: a scanner without a camera drives half
// a metre past them. Prints the landmarks; exit code 1 if they are not where the posts stand.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <vector>

#include "detection/detect.hpp"
#include "detection/rig.hpp"
#include "geometry/camera_model.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "mapping/mapper.hpp"
#include "mapping/mapper_config.hpp"
#include "pose/pose_estimate.hpp"

namespace {

constexpr double kPi = 3.14159265358979323846;

struct Post {
  double x_m, y_m, radius_m;  // map frame
};
const std::vector<Post> kPosts = {{1.5, 0.8, 0.045},
                                  {2.5, 0.8, 0.045},
                                  {1.5, -0.8, 0.045},
                                  {2.5, -0.8, 0.045},
                                  {3.2, 0.1, 0.085}};

// Range from (x_m, 0) along `bearing_rad` to the nearest post; 0 = no return.
float range_m(double x_m, double bearing_rad) {
  const double ux = std::cos(bearing_rad);
  const double uy = std::sin(bearing_rad);
  double nearest_m = 0.0;
  for (const Post& post : kPosts) {
    const double dx = post.x_m - x_m;
    const double along_m = dx * ux + post.y_m * uy;
    const double across_m = dx * uy - post.y_m * ux;
    const double half_chord2 = post.radius_m * post.radius_m - across_m * across_m;
    if (along_m <= 0.0 || half_chord2 < 0.0) continue;
    const double to_surface_m = along_m - std::sqrt(half_chord2);
    if (nearest_m == 0.0 || to_surface_m < nearest_m) nearest_m = to_surface_m;
  }
  return static_cast<float>(nearest_m);
}

orchard::laser::Scan scan_from(double x_m, int seq) {
  orchard::laser::Scan scan;
  scan.utime = 1'000'000 + std::int64_t{seq} * 500'000;
  scan.seq = seq;
  scan.bearing_min_rad = -kPi / 2;
  scan.bearing_step_rad = kPi / 720;  // a quarter of a degree
  scan.range_min_m = 0.05;
  scan.range_max_m = 20.0;
  for (int i = 0; i <= 720; ++i) {
    scan.ranges_m.push_back(range_m(x_m, scan.bearing_rad(i)));
  }
  return scan;
}

}  // namespace

int main() {
  orchard::geometry::CameraConfig no_camera;
  no_camera.enabled = false;
  const orchard::detection::Rig rig({}, no_camera, {});  // trunks of 90 mm
  orchard::mapping::Mapper mapper{orchard::mapping::MapperConfig{}};
  for (int seq = 0; seq < 5; ++seq) {
    const double x_m = 0.1 * seq;
    const orchard::laser::Scan scan = scan_from(x_m, seq);
    const auto found = orchard::detection::find_by_laser(scan, rig);
    orchard::pose::PoseEstimate T_map_base;
    T_map_base.utime = scan.utime;
    T_map_base.x_m = x_m;
    mapper.update(found.detections, T_map_base);
  }

  bool right = mapper.num_landmarks() == kPosts.size();
  std::printf("id,class,x_m,y_m,width_m,n\n");
  for (const auto& landmark : mapper.landmarks()) {
    const bool tree = landmark.label == orchard::detection::Label::kTree;
    std::printf("%d,%s,%.3f,%.3f,%.3f,%d\n", landmark.id, tree ? "tree" : "object", landmark.x_m,
                landmark.y_m, landmark.width_m, landmark.num_observations);
    bool stands_there = false;
    for (const Post& post : kPosts) {
      stands_there |= std::hypot(post.x_m - landmark.x_m, post.y_m - landmark.y_m) < 0.02 &&
                      std::abs(2.0 * post.radius_m - landmark.width_m) < 0.015 &&
                      tree == (post.radius_m < 0.06) && landmark.num_observations == 5;
    }
    right = right && stands_there;
  }
  std::printf(right ? "found all posts\n" : "WRONG: not what stands there\n");
  return right ? 0 : 1;
}
