// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "detection/detector_config.hpp"
#include "geometry/camera_config.hpp"
#include "geometry/camera_model.hpp"
#include "geometry/laser_camera.hpp"
#include "laser/laser_config.hpp"

namespace orchard::detection {

/// Sensor models, extrinsics and detector parameters of one robot.
struct Rig {
  Rig(const laser::LaserConfig& laser_config, const geometry::CameraConfig& camera_config,
      const DetectorConfig& detector_config)
      : laser(laser_config),
        has_camera(camera_config.enabled),
        camera(camera_config.intrinsics),
        T_camera_laser(camera_config.extrinsics),
        camera_delay_s(camera_config.delay_s),
        detector(detector_config) {}

  laser::LaserConfig laser;
  bool has_camera = true;
  geometry::CameraModel camera;
  geometry::LaserToCamera T_camera_laser;
  double camera_delay_s = 0.0;  ///< exposure = an image's utime - camera_delay_s
  DetectorConfig detector;
};

}  // namespace orchard::detection
