// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "pose/measurements.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// A block of trees and posts as it stands on one day.
struct PriorWorld {
  std::vector<PriorLandmark> trees;
  double length_m = 0.0;  ///< of a row
  double row_spacing_m = 4.0;
  int num_rows = 0;
};

struct PriorWorldOptions {
  int num_rows = 10;
  int trees_per_row = 30;
  double row_spacing_m = 4.0;
  double tree_spacing_m = 2.5;
  double jitter_m = 0.15;  ///< standard deviation along each axis
  double missing_fraction = 0.08;
  double width_m = 0.125;
  double width_sd_m = 0.012;
};

PriorWorld prior_world(std::uint64_t seed, const PriorWorldOptions& options = {});

/// The map that a first drive has made of it: each position off by this much along each axis.
std::vector<PriorLandmark> mapped(const PriorWorld& world, std::uint64_t seed, double sd_m = 0.04,
                                  double width_sd_m = 0.006);

/// The block some time later: this fraction of its trees is gone, and as many stand elsewhere.
PriorWorld changed(const PriorWorld& world, std::uint64_t seed, double fraction);

/// T_map_base along the way through all alleys, half a circle from each to the next, every 2 cm.
std::vector<Eigen::Vector3d> way_through(const PriorWorld& world, double headland_m = 3.0);

/// A stretch of the way: metres from its beginning; backwards when `to` lies before `from`.
struct Stretch {
  double from_m = 0.0;
  double to_m = 0.0;
};

struct PriorDriveOptions {
  double speed_mps = 1.0;
  double sight_range_m = 5.6;
  double sight_half_angle_rad = 2.09;
  double beam_step_rad = 0.00614;
  double miss_probability = 0.05;
  double false_per_scan = 0.2;
  double speed_scale_sd = 0.03;
  double turn_scale_sd = 0.03;
  double yaw_rate_bias_sd_radps = 0.002;
  double silent_from_s = 1e9;  ///< odometry that fails
  double silent_to_s = 1e9;
};

/// Drives along the stretches of the way, one after the other; between two of them the robot is
/// carried, and its odometry says that it stands. After each measurement, in order of time, `told`
/// gets it with the true T_map_base and the metres driven so far; it ends the drive by returning
/// false.
void drive(const PriorWorld& world, const std::vector<Eigen::Vector3d>& way,
           const std::vector<Stretch>& stretches, std::uint64_t seed,
           const PriorDriveOptions& options,
           const std::function<bool(const Measurement&, const Eigen::Vector3d& T_map_base,
                                    double driven_m)>& told);

}  // namespace orchard::pose
