// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "bus/messages/message.hpp"

namespace orchard::bus::testing {

/// The head of a JPEG up to its frame header, and a few bytes more: all that the guard reads.
inline std::vector<std::uint8_t> jpeg_head(int width_px, int height_px) {
  const auto high = [](int value) { return static_cast<std::uint8_t>(value >> 8); };
  const auto low = [](int value) { return static_cast<std::uint8_t>(value & 255); };
  return {0xFF,
          0xD8,
          0xFF,
          0xE0,
          0,
          4,
          1,
          2,
          0xFF,
          0xC0,
          0,
          17,
          8,
          high(height_px),
          low(height_px),
          high(width_px),
          low(width_px),
          3,
          1,
          0x22,
          0,
          2,
          0x11,
          1,
          3,
          0x11,
          1,
          7};
}

/// One well-formed message of each source and derived channel, every field set to something.
inline std::vector<Message> sample_messages(std::int64_t utime = 1700000000000000,
                                            std::int32_t seq = 3) {
  laser::Scan scan;
  scan.utime = utime;
  scan.seq = seq;
  scan.bearing_min_rad = -1.5;
  scan.bearing_step_rad = 0.25;
  scan.beam_period_us = 97.5;
  scan.range_min_m = 0.06;
  scan.range_max_m = 4.1;
  scan.ranges_m = {0.0f, 1.5f, 2.25f};
  scan.intensities = {10.0f, 20.0f, 30.5f};

  vision::Image image;
  image.utime = utime;
  image.seq = seq;
  image.width_px = 320;
  image.height_px = 240;
  image.data = jpeg_head(320, 240);

  pose::Odometry odometry;
  odometry.utime = utime;
  odometry.seq = seq;
  odometry.speed_mps = 0.7;
  odometry.yaw_rate_radps = -0.2;
  odometry.covariance = {1e-4, 1e-6, 2e-4};

  pose::Gnss gnss;
  gnss.utime = utime;
  gnss.seq = seq;
  gnss.latitude_deg = -32.4;
  gnss.longitude_deg = -71.4;
  gnss.altitude_m = 40.0;
  gnss.covariance = {1, 0.1, 0.2, 2, 0.3, 3};
  gnss.fix_quality = 4;

  pose::PoseFix fix;
  fix.utime = utime;
  fix.seq = seq;
  fix.x_m = 12.5;
  fix.y_m = -3.25;
  fix.yaw_rad = 1.0;
  fix.covariance = {1, 0.1, 0.2, 2, 0.3, 3};
  fix.has_yaw = true;

  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.seq = seq;
  pose.x_m = 1.0;
  pose.y_m = 2.0;
  pose.yaw_rad = -3.0;
  pose.pitch_rad = 0.1;
  pose.roll_rad = -0.1;
  pose.covariance = {1, 0.1, 0.2, 2, 0.3, 3};

  detection::Detection trunk;
  trunk.utime = utime + 5;
  trunk.range_m = 2.0;
  trunk.bearing_rad = 0.3;
  trunk.surface_x_m = 1.9;
  trunk.surface_y_m = 0.6;
  trunk.centre_x_m = 1.95;
  trunk.centre_y_m = 0.62;
  trunk.covariance = {1e-4, 1e-5, 2e-4};
  trunk.width_m = 0.09;
  trunk.width_sd_m = 0.005;
  trunk.roc_laser = 0.9f;
  trunk.roc_colour = 0.8f;
  trunk.roc_left_edge = 0.7f;
  trunk.roc_right_edge = 0.6f;
  trunk.roc_parallel = 0.5f;
  trunk.roc_edges = 0.6f;
  trunk.roc_vision = 0.72f;
  trunk.roc_tree = 0.81f;
  trunk.probability_tree = 0.7f;
  trunk.probability_object = 0.2f;
  trunk.intensity = 345.0f;
  trunk.num_beams = 9;
  trunk.label = detection::Label::kTree;
  trunk.occlusion = detection::kOccludedLeft;
  detection::Detections detections;
  detections.utime = utime;
  detections.seq = seq;
  detections.image_utime = utime + 2;
  detections.trunks = {trunk, trunk};

  mapping::Landmark landmark;
  landmark.id = 7;
  landmark.label = detection::Label::kObject;
  landmark.num_observations = 4;
  landmark.x_m = 3.0;
  landmark.y_m = 4.0;
  landmark.se_x_m = 0.003;
  landmark.se_y_m = 0.004;
  landmark.covariance = {1e-4, 1e-5, 2e-4};
  landmark.width_m = 0.17;
  landmark.roc_mean = 0.3;
  landmark.probability = 0.2;
  landmark.row = 1;
  landmark.position = 5;
  mapping::MapTile tile;
  tile.utime = utime;
  tile.seq = seq;
  tile.num_landmarks_total = 12;
  tile.landmarks = {landmark, landmark};
  tile.removed_ids = {3, 4};

  detection::AdaptationStep step;
  step.utime = utime;
  step.seq = seq;
  step.action = detection::AdaptationAction::kRollback;
  step.reason = detection::AdaptationReason::kConfidenceCollapsed;
  step.num_width_trees = 11;
  step.num_colour_trees = 9;
  step.confident_share = 0.4;
  step.model = {0.123, {-0.2, 0.1, 0.3}};

  pose::Imu imu;
  imu.utime = utime;
  imu.seq = seq;
  imu.angular_rate_radps = {0.01, -0.02, 0.3};
  imu.acceleration_mps2 = {0.5, -0.25, 9.8};
  imu.angular_rate_variance = 1e-6;
  imu.acceleration_variance = 1e-3;
  imu.roll_rad = 0.02;
  imu.pitch_rad = -0.03;
  imu.yaw_rad = 1.5;
  imu.orientation_variance = 1e-4;
  imu.has_orientation = true;

  pose::TrajectoryPage page;
  page.utime = utime;
  page.seq = seq;
  page.revision = 2;
  page.page = 1;
  page.num_pages = 3;
  page.poses = {pose, pose};
  page.poses[0].seq = page.poses[1].seq = 0;
  page.poses[0].utime = utime - 2000;
  page.poses[1].utime = utime - 1000;

  return {scan, image, odometry, gnss, fix, pose, detections, tile, step, imu, page};
}

}  // namespace orchard::bus::testing
