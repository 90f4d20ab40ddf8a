// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

// Conversion of sensor data and maps to JSON in Foxglove's schemas (docs.foxglove.dev, "schemas"),
// which Foxglove and Lichtblick display. Frames are map, base, laser and camera.

/// A registered schema name and the JSON schema of the fields that we write.
struct FoxgloveSchema {
  const char* name;
  std::string json;
};
FoxgloveSchema foxglove_schema(const char* name);

/// foxglove.LaserScan. A beam without return is 0.
std::string foxglove_json(const laser::Scan& scan, const char* frame);
/// foxglove.CompressedImage of a JPEG, foxglove.RawImage otherwise.
std::string foxglove_json(const vision::Image& image);
/// foxglove.LocationFix.
std::string foxglove_json(const pose::Gnss& gnss);
/// foxglove.PoseInFrame, and of the same pose foxglove.FrameTransforms from map to base.
std::string foxglove_json(const pose::PoseEstimate& pose);
std::string foxglove_transform(const pose::PoseEstimate& pose);
/// orchard.Odometry and orchard.Imu: numbers for plots.
std::string foxglove_json(const pose::Odometry& odometry);
std::string foxglove_json(const pose::Imu& imu);
/// foxglove.PoseInFrame of an external position.
std::string foxglove_json(const pose::PoseFix& fix);

/// foxglove.FrameTransforms from base to laser and to camera.
std::string foxglove_mounts(std::int64_t utime, const laser::LaserConfig& laser,
                            const geometry::CameraConfig& camera);
/// foxglove.CameraCalibration.
std::string foxglove_calibration(std::int64_t utime, const geometry::CameraIntrinsics& camera);

/// foxglove.SceneUpdate: each landmark as a cylinder of its width, labelled with its number (and
/// row and position) and coloured by class; deletes those of `removed_ids`.
std::string foxglove_scene(std::int64_t utime, const std::vector<mapping::Landmark>& landmarks,
                           const std::vector<std::int32_t>& removed_ids);
/// foxglove.SceneUpdate: the detections of one scan, in base.
std::string foxglove_scene(const detection::Detections& detections);
/// foxglove.SceneUpdate: a path as a line in map.
std::string foxglove_path(std::int64_t utime, const std::vector<pose::PoseEstimate>& path);

}  // namespace orchard::io
