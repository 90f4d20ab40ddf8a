// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/slam_peers/recorded_drive.hpp"
#include "geometry/pose2.hpp"

#include <cmath>
#include <optional>

namespace orchard::bench {
namespace {

constexpr double kSameTreeM = 0.5;

// T_before_now from the velocities at both ends of a time.
Eigen::Vector3d arc(const pose::Odometry& before, const pose::Odometry& now) {
  const double seconds = static_cast<double>(now.utime - before.utime) * 1e-6;
  const double turn_rad = 0.5 * (before.yaw_rate_radps + now.yaw_rate_radps) * seconds;
  const double way_m = 0.5 * (before.speed_mps + now.speed_mps) * seconds;
  return {way_m * std::cos(0.5 * turn_rad), way_m * std::sin(0.5 * turn_rad), turn_rad};
}

}  // namespace

RecordedDrive record_drive(std::uint64_t seed, int num_trees) {
  // as near to square as a block is, with an alley at least
  const int rows = std::max(2, static_cast<int>(std::lround(std::sqrt(num_trees / 2.0))));
  const int trees_per_row = static_cast<int>(std::ceil(static_cast<double>(num_trees) / rows));
  const pose::SlamWorld world = pose::SlamWorld::block(seed, rows, trees_per_row, 2);

  RecordedDrive drive;
  std::optional<Eigen::Vector3d> start;
  std::vector<pose::Odometry> waiting;
  std::optional<pose::Odometry> last;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  pose::run(world, seed,
            {[&](const pose::Odometry& odometry) {
               if (last) moved = geometry::compose(moved, arc(*last, odometry));
               last = odometry;
               waiting.push_back(odometry);
             },
             [&](const detection::Detections& seen) {
               drive.odometry.push_back(std::move(waiting));
               waiting.clear();
               DriveStep step;
               step.seen = seen;
               step.T_before_now = moved;
               moved.setZero();
               drive.steps.push_back(std::move(step));
             },
             [&](std::int64_t, const Eigen::Vector3d& T_map_base) {
               if (!start) start = T_map_base;
               DriveStep& step = drive.steps.back();
               step.T_start_base = geometry::between(*start, T_map_base);
               for (const detection::Detection& trunk : step.seen.trunks) {
                 const Eigen::Vector2d p_map =
                     geometry::transform(T_map_base, {trunk.centre_x_m, trunk.centre_y_m});
                 int nearest = -1;
                 double nearest_m = kSameTreeM;
                 for (std::size_t i = 0; i < world.trees.size(); ++i) {
                   const double distance_m = (world.trees[i].p_map - p_map).norm();
                   if (distance_m >= nearest_m) continue;
                   nearest_m = distance_m;
                   nearest = static_cast<int>(i);
                 }
                 step.trees.push_back(nearest);
               }
             }});
  for (const pose::SlamWorld::Tree& tree : world.trees) {
    drive.trees.push_back(geometry::inverse_transform(*start, tree.p_map));
  }
  return drive;
}

}  // namespace orchard::bench
