// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/slam_peers/recorded_drive.hpp"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>

#include "geometry/pose2.hpp"

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

constexpr double kHalfAngleRad = 2.09;
constexpr double kRangeMaxM = 5.6;
constexpr int kNumBeams = 683;  // 0.352 degrees apart
constexpr double kYawSdRad = 0.003;

mrpt::obs::CActionCollection action_of(const DriveStep& step, mrpt::Clock::time_point time) {
  // Standard deviations that own up to wheels off by 3 % in way and 0.002 rad/s in turn.
  mrpt::obs::CActionRobotMovement2D::TMotionModelOptions options;
  options.modelSelection = mrpt::obs::CActionRobotMovement2D::mmGaussian;
  options.gaussianModel.a1 = 0.05f;
  options.gaussianModel.a2 = 0.0f;
  options.gaussianModel.a3 = 0.0f;
  options.gaussianModel.a4 = 0.05f;
  options.gaussianModel.minStdXY = 0.002f;
  options.gaussianModel.minStdPHI = 0.002f;
  mrpt::obs::CActionRobotMovement2D movement;
  movement.computeFromOdometry(
      {step.T_before_now.x(), step.T_before_now.y(), step.T_before_now.z()}, options);
  movement.timestamp = time;
  mrpt::obs::CActionCollection collection;
  collection.insert(movement);
  return collection;
}

mrpt::obs::CObservation::Ptr bearings_of(const DriveStep& step, bool identified) {
  auto observation = std::make_shared<mrpt::obs::CObservationBearingRange>();
  observation->maxSensorDistance = static_cast<float>(kRangeMaxM);
  observation->fieldOfView_yaw = static_cast<float>(2.0 * kHalfAngleRad);
  observation->sensor_std_range = 0.04f;
  observation->sensor_std_yaw = static_cast<float>(kYawSdRad);
  observation->sensor_std_pitch = 0.01f;
  std::set<int> named;  // a false sighting near a tree is no second sighting of it
  for (std::size_t i = 0; i < step.seen.trunks.size(); ++i) {
    const int tree = step.trees[i];
    if (identified && (tree < 0 || !named.insert(tree).second)) continue;
    const detection::Detection& trunk = step.seen.trunks[i];
    mrpt::obs::CObservationBearingRange::TMeasurement m;
    m.range = static_cast<float>(std::hypot(trunk.centre_x_m, trunk.centre_y_m));
    m.yaw = static_cast<float>(std::atan2(trunk.centre_y_m, trunk.centre_x_m));
    m.pitch = 0.0f;
    m.landmarkID = identified ? tree : mrpt::obs::INVALID_LANDMARK_ID;
    observation->sensedData.push_back(m);
  }
  return observation;
}

mrpt::obs::CObservation::Ptr scan_of(const DriveStep& step) {
  auto scan = std::make_shared<mrpt::obs::CObservation2DRangeScan>();
  scan->aperture = static_cast<float>(2.0 * kHalfAngleRad);
  scan->rightToLeft = true;
  scan->maxRange = static_cast<float>(kRangeMaxM);
  scan->stdError = 0.02f;
  scan->resizeScanAndAssign(kNumBeams, static_cast<float>(kRangeMaxM), false);
  const double beam_step_rad = 2.0 * kHalfAngleRad / (kNumBeams - 1);
  for (const detection::Detection& trunk : step.seen.trunks) {
    const double range_m = std::hypot(trunk.centre_x_m, trunk.centre_y_m);
    const double bearing_rad = std::atan2(trunk.centre_y_m, trunk.centre_x_m);
    const double radius_m = std::min(0.5 * trunk.width_m, 0.5 * range_m);
    const double half_rad = std::asin(radius_m / range_m);
    for (int beam = 0; beam < kNumBeams; ++beam) {
      const double off_rad = beam * beam_step_rad - kHalfAngleRad - bearing_rad;
      if (std::abs(off_rad) > half_rad) continue;
      const double across_m = range_m * std::sin(off_rad);
      const double surface_m = range_m * std::cos(off_rad) -
                               std::sqrt(std::max(0.0, radius_m * radius_m - across_m * across_m));
      const auto index = static_cast<std::size_t>(beam);
      if (scan->getScanRangeValidity(index) && scan->getScanRange(index) < surface_m) continue;
      scan->setScanRange(index, static_cast<float>(surface_m));
      scan->setScanRangeValidity(index, true);
    }
  }
  return scan;
}

}  // namespace

RecordedDrive record_drive(std::uint64_t seed, int num_trees) {
  // as near to square as a block is, with an aisle at least
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

void write_rawlog(const RecordedDrive& drive, Sightings sightings, const std::string& path) {
  mrpt::obs::CRawlog rawlog;
  for (const DriveStep& step : drive.steps) {
    const auto time = mrpt::Clock::fromDouble(static_cast<double>(step.seen.utime) * 1e-6);
    auto action = action_of(step, time);
    rawlog.insert(action);
    const auto observation = sightings == Sightings::kScan
                                 ? scan_of(step)
                                 : bearings_of(step, sightings == Sightings::kIdentified);
    observation->timestamp = time;
    mrpt::obs::CSensoryFrame frame;
    frame.insert(observation);
    rawlog.insert(frame);
  }
  if (!rawlog.saveToRawLogFile(path)) throw std::runtime_error("cannot write " + path);
}

}  // namespace orchard::bench
