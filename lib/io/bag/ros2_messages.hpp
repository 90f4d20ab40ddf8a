// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "detection/detection.hpp"
#include "geometry/camera_model.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "mapping/landmark.hpp"
#include "pose/measurements.hpp"
#include "pose/pose_estimate.hpp"
#include "vision/image.hpp"

namespace orchard::io {

// Sensor data and maps as messages of ROS 2, which Foxglove, RViz and rosbag2 read. Frames are map,
// base, laser, laser_rear, camera (optical) and odom.

/// A message as it stands in a bag of ROS 2.
struct Ros2Message {
  const char* topic;
  const char* type;  ///< "sensor_msgs/msg/LaserScan"
  std::int64_t utime;
  std::string cdr;
};

/// /scan and /scan_rear. A beam without return is infinite (REP 117).
Ros2Message ros2_message(const laser::Scan& scan);
Ros2Message ros2_message(const laser::RearScan& scan);
/// /camera/image_raw/compressed of a JPEG, /camera/image_raw otherwise.
Ros2Message ros2_message(const vision::Image& image);
/// /odom: velocities only; its pose is zero.
Ros2Message ros2_message(const pose::Odometry& odometry);
Ros2Message ros2_message(const pose::Imu& imu);
Ros2Message ros2_message(const pose::Gnss& gnss);
Ros2Message ros2_message(const pose::PoseFix& fix);
/// /tf from map to base.
Ros2Message ros2_message(const pose::PoseEstimate& pose);
/// /detections of one scan as cylinders in base.
Ros2Message ros2_message(const detection::Detections& detections);

/// /tf_static from base to the scanners and the antenna, and from laser to camera.
Ros2Message ros2_mounts(std::int64_t utime, const laser::LaserConfig& laser,
                        const laser::RearLaserConfig& rear, const geometry::CameraConfig& camera,
                        const std::array<double, 2>& antenna_m);
/// /camera/camera_info.
Ros2Message ros2_camera_info(std::int64_t utime, const geometry::CameraIntrinsics& camera);
/// /map: each landmark as a cylinder of its width, coloured by class, with its number (or row and
/// position) above it; deletes those of `removed_ids`.
Ros2Message ros2_map(std::int64_t utime, const std::vector<mapping::Landmark>& landmarks,
                     const std::vector<std::int32_t>& removed_ids);
/// /map/path.
Ros2Message ros2_path(std::int64_t utime, const std::vector<pose::PoseEstimate>& path);

}  // namespace orchard::io
