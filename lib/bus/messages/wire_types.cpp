// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/wire_types.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace orchard::bus {
namespace {

template <std::size_t N>
void copy(const std::array<double, N>& from, double (&to)[N]) {
  std::copy(from.begin(), from.end(), to);
}

template <std::size_t N>
void copy(const double (&from)[N], std::array<double, N>& to) {
  std::copy(from, from + N, to.begin());
}

trunk_v2_t to_wire(const detection::Detection& trunk) {
  trunk_v2_t wire;
  wire.utime = trunk.utime;
  wire.range_m = trunk.range_m;
  wire.bearing_rad = trunk.bearing_rad;
  wire.surface_x_m = trunk.surface_x_m;
  wire.surface_y_m = trunk.surface_y_m;
  wire.centre_x_m = trunk.centre_x_m;
  wire.centre_y_m = trunk.centre_y_m;
  copy(trunk.covariance, wire.covariance);
  wire.width_m = trunk.width_m;
  wire.width_sd_m = trunk.width_sd_m;
  wire.roc_laser = trunk.roc_laser;
  wire.roc_colour = trunk.roc_colour;
  wire.roc_left_edge = trunk.roc_left_edge;
  wire.roc_right_edge = trunk.roc_right_edge;
  wire.roc_parallel = trunk.roc_parallel;
  wire.roc_edges = trunk.roc_edges;
  wire.roc_vision = trunk.roc_vision;
  wire.roc_tree = trunk.roc_tree;
  wire.probability_tree = trunk.probability_tree;
  wire.probability_object = trunk.probability_object;
  wire.intensity = trunk.intensity;
  wire.num_beams = trunk.num_beams;
  wire.label = static_cast<std::int8_t>(trunk.label);
  wire.occlusion = trunk.occlusion;
  return wire;
}

/// What trunk_t and trunk_v2_t have in common.
template <class WireTrunk>
detection::Detection common_from_wire(const WireTrunk& wire) {
  detection::Detection trunk;
  trunk.utime = wire.utime;
  trunk.range_m = wire.range_m;
  trunk.bearing_rad = wire.bearing_rad;
  trunk.surface_x_m = wire.surface_x_m;
  trunk.surface_y_m = wire.surface_y_m;
  trunk.centre_x_m = wire.centre_x_m;
  trunk.centre_y_m = wire.centre_y_m;
  copy(wire.covariance, trunk.covariance);
  trunk.width_m = wire.width_m;
  trunk.width_sd_m = wire.width_sd_m;
  trunk.roc_laser = wire.roc_laser;
  trunk.roc_colour = wire.roc_colour;
  trunk.roc_left_edge = wire.roc_left_edge;
  trunk.roc_right_edge = wire.roc_right_edge;
  trunk.roc_parallel = wire.roc_parallel;
  trunk.roc_edges = wire.roc_edges;
  trunk.roc_vision = wire.roc_vision;
  trunk.roc_tree = wire.roc_tree;
  trunk.num_beams = wire.num_beams;
  trunk.label = static_cast<detection::Label>(wire.label);
  trunk.occlusion = wire.occlusion;
  return trunk;
}

detection::Detection from_wire(const trunk_t& wire) { return common_from_wire(wire); }

detection::Detection from_wire(const trunk_v2_t& wire) {
  detection::Detection trunk = common_from_wire(wire);
  trunk.probability_tree = wire.probability_tree;
  trunk.probability_object = wire.probability_object;
  trunk.intensity = wire.intensity;
  return trunk;
}

template <class WireDetections>
detection::Detections detections_from_wire(const WireDetections& wire) {
  detection::Detections detections;
  detections.utime = wire.utime;
  detections.seq = wire.seq;
  detections.image_utime = wire.image_utime;
  detections.trunks.reserve(wire.trunks.size());
  for (const auto& trunk : wire.trunks) detections.trunks.push_back(from_wire(trunk));
  return detections;
}

landmark_t to_wire(const mapping::Landmark& landmark) {
  landmark_t wire;
  wire.id = landmark.id;
  wire.label = static_cast<std::int8_t>(landmark.label);
  wire.num_observations = landmark.num_observations;
  wire.x_m = landmark.x_m;
  wire.y_m = landmark.y_m;
  wire.se_x_m = landmark.se_x_m;
  wire.se_y_m = landmark.se_y_m;
  copy(landmark.covariance, wire.covariance);
  wire.width_m = landmark.width_m;
  wire.roc_mean = landmark.roc_mean;
  wire.probability = landmark.probability;
  wire.row = landmark.row;
  wire.position = landmark.position;
  return wire;
}

mapping::Landmark from_wire(const landmark_t& wire) {
  mapping::Landmark landmark;
  landmark.id = wire.id;
  landmark.label = static_cast<detection::Label>(wire.label);
  landmark.num_observations = wire.num_observations;
  landmark.x_m = wire.x_m;
  landmark.y_m = wire.y_m;
  landmark.se_x_m = wire.se_x_m;
  landmark.se_y_m = wire.se_y_m;
  copy(wire.covariance, landmark.covariance);
  landmark.width_m = wire.width_m;
  landmark.roc_mean = wire.roc_mean;
  landmark.probability = wire.probability;
  landmark.row = wire.row;
  landmark.position = wire.position;
  return landmark;
}

}  // namespace

scan_t to_wire(const laser::Scan& scan) {
  scan_t wire;
  wire.utime = scan.utime;
  wire.seq = scan.seq;
  wire.num_ranges = static_cast<std::int32_t>(scan.ranges_m.size());
  wire.num_intensities = static_cast<std::int32_t>(scan.intensities.size());
  wire.bearing_min_rad = scan.bearing_min_rad;
  wire.bearing_step_rad = scan.bearing_step_rad;
  wire.beam_period_us = scan.beam_period_us;
  wire.range_min_m = scan.range_min_m;
  wire.range_max_m = scan.range_max_m;
  wire.ranges_m = scan.ranges_m;
  wire.intensities = scan.intensities;
  return wire;
}

laser::Scan from_wire(scan_t&& wire) {
  laser::Scan scan;
  scan.utime = wire.utime;
  scan.seq = wire.seq;
  scan.bearing_min_rad = wire.bearing_min_rad;
  scan.bearing_step_rad = wire.bearing_step_rad;
  scan.beam_period_us = wire.beam_period_us;
  scan.range_min_m = wire.range_min_m;
  scan.range_max_m = wire.range_max_m;
  scan.ranges_m = std::move(wire.ranges_m);
  scan.intensities = std::move(wire.intensities);
  return scan;
}

image_t to_wire(const vision::Image& image) {
  image_t wire;
  wire.utime = image.utime;
  wire.seq = image.seq;
  wire.num_bytes = static_cast<std::int32_t>(image.data.size());
  wire.width_px = image.width_px;
  wire.height_px = image.height_px;
  wire.encoding = static_cast<std::int8_t>(image.encoding);
  wire.data = image.data;
  return wire;
}

vision::Image from_wire(image_t&& wire) {
  vision::Image image;
  image.utime = wire.utime;
  image.seq = wire.seq;
  image.width_px = wire.width_px;
  image.height_px = wire.height_px;
  image.encoding = static_cast<vision::Encoding>(wire.encoding);
  image.data = std::move(wire.data);
  return image;
}

odometry_t to_wire(const pose::Odometry& odometry) {
  odometry_t wire;
  wire.utime = odometry.utime;
  wire.seq = odometry.seq;
  wire.speed_mps = odometry.speed_mps;
  wire.yaw_rate_radps = odometry.yaw_rate_radps;
  copy(odometry.covariance, wire.covariance);
  return wire;
}

pose::Odometry from_wire(odometry_t&& wire) {
  pose::Odometry odometry;
  odometry.utime = wire.utime;
  odometry.seq = wire.seq;
  odometry.speed_mps = wire.speed_mps;
  odometry.yaw_rate_radps = wire.yaw_rate_radps;
  copy(wire.covariance, odometry.covariance);
  return odometry;
}

gnss_t to_wire(const pose::Gnss& gnss) {
  gnss_t wire;
  wire.utime = gnss.utime;
  wire.seq = gnss.seq;
  wire.latitude_deg = gnss.latitude_deg;
  wire.longitude_deg = gnss.longitude_deg;
  wire.altitude_m = gnss.altitude_m;
  copy(gnss.covariance, wire.covariance);
  wire.fix_quality = gnss.fix_quality;
  return wire;
}

pose::Gnss from_wire(gnss_t&& wire) {
  pose::Gnss gnss;
  gnss.utime = wire.utime;
  gnss.seq = wire.seq;
  gnss.latitude_deg = wire.latitude_deg;
  gnss.longitude_deg = wire.longitude_deg;
  gnss.altitude_m = wire.altitude_m;
  copy(wire.covariance, gnss.covariance);
  gnss.fix_quality = wire.fix_quality;
  return gnss;
}

pose_fix_t to_wire(const pose::PoseFix& fix) {
  pose_fix_t wire;
  wire.utime = fix.utime;
  wire.seq = fix.seq;
  wire.x_m = fix.x_m;
  wire.y_m = fix.y_m;
  wire.yaw_rad = fix.yaw_rad;
  copy(fix.covariance, wire.covariance);
  wire.has_yaw = fix.has_yaw ? 1 : 0;
  return wire;
}

pose::PoseFix from_wire(pose_fix_t&& wire) {
  if (wire.has_yaw != 0 && wire.has_yaw != 1) {
    throw std::range_error("has_yaw = " + std::to_string(wire.has_yaw));
  }
  pose::PoseFix fix;
  fix.utime = wire.utime;
  fix.seq = wire.seq;
  fix.x_m = wire.x_m;
  fix.y_m = wire.y_m;
  fix.yaw_rad = wire.yaw_rad;
  copy(wire.covariance, fix.covariance);
  fix.has_yaw = wire.has_yaw == 1;
  return fix;
}

pose_t to_wire(const pose::PoseEstimate& pose) {
  pose_t wire;
  wire.utime = pose.utime;
  wire.seq = pose.seq;
  wire.x_m = pose.x_m;
  wire.y_m = pose.y_m;
  wire.yaw_rad = pose.yaw_rad;
  wire.pitch_rad = pose.pitch_rad;
  wire.roll_rad = pose.roll_rad;
  copy(pose.covariance, wire.covariance);
  return wire;
}

pose::PoseEstimate from_wire(pose_t&& wire) {
  pose::PoseEstimate pose;
  pose.utime = wire.utime;
  pose.seq = wire.seq;
  pose.x_m = wire.x_m;
  pose.y_m = wire.y_m;
  pose.yaw_rad = wire.yaw_rad;
  pose.pitch_rad = wire.pitch_rad;
  pose.roll_rad = wire.roll_rad;
  copy(wire.covariance, pose.covariance);
  return pose;
}

detections_v2_t to_wire(const detection::Detections& detections) {
  detections_v2_t wire;
  wire.utime = detections.utime;
  wire.seq = detections.seq;
  wire.num_trunks = static_cast<std::int32_t>(detections.trunks.size());
  wire.image_utime = detections.image_utime;
  wire.trunks.reserve(detections.trunks.size());
  for (const detection::Detection& trunk : detections.trunks) {
    wire.trunks.push_back(to_wire(trunk));
  }
  return wire;
}

detection::Detections from_wire(detections_v2_t&& wire) { return detections_from_wire(wire); }

detection::Detections from_wire(detections_t&& wire) { return detections_from_wire(wire); }

map_tile_t to_wire(const mapping::MapTile& tile) {
  map_tile_t wire;
  wire.utime = tile.utime;
  wire.seq = tile.seq;
  wire.num_landmarks = static_cast<std::int32_t>(tile.landmarks.size());
  wire.num_removed = static_cast<std::int32_t>(tile.removed_ids.size());
  wire.num_landmarks_total = tile.num_landmarks_total;
  wire.landmarks.reserve(tile.landmarks.size());
  for (const mapping::Landmark& landmark : tile.landmarks) {
    wire.landmarks.push_back(to_wire(landmark));
  }
  wire.removed_ids = tile.removed_ids;
  return wire;
}

mapping::MapTile from_wire(map_tile_t&& wire) {
  mapping::MapTile tile;
  tile.utime = wire.utime;
  tile.seq = wire.seq;
  tile.num_landmarks_total = wire.num_landmarks_total;
  tile.landmarks.reserve(wire.landmarks.size());
  for (const landmark_t& landmark : wire.landmarks) tile.landmarks.push_back(from_wire(landmark));
  tile.removed_ids = std::move(wire.removed_ids);
  return tile;
}

adaptation_t to_wire(const detection::AdaptationStep& step) {
  adaptation_t wire;
  wire.utime = step.utime;
  wire.seq = step.seq;
  wire.action = static_cast<std::int8_t>(step.action);
  wire.reason = static_cast<std::int8_t>(step.reason);
  wire.num_width_trees = step.num_width_trees;
  wire.num_colour_trees = step.num_colour_trees;
  wire.confident_share = step.confident_share;
  wire.width_mean_m = step.model.width_mean_m;
  wire.light_blue = step.model.light.blue;
  wire.light_red = step.model.light.red;
  wire.light_green = step.model.light.green;
  return wire;
}

detection::AdaptationStep from_wire(adaptation_t&& wire) {
  detection::AdaptationStep step;
  step.utime = wire.utime;
  step.seq = wire.seq;
  step.action = static_cast<detection::AdaptationAction>(wire.action);
  step.reason = static_cast<detection::AdaptationReason>(wire.reason);
  step.num_width_trees = wire.num_width_trees;
  step.num_colour_trees = wire.num_colour_trees;
  step.confident_share = wire.confident_share;
  step.model.width_mean_m = wire.width_mean_m;
  step.model.light = {wire.light_blue, wire.light_red, wire.light_green};
  return step;
}

imu_t to_wire(const pose::Imu& imu) {
  imu_t wire;
  wire.utime = imu.utime;
  wire.seq = imu.seq;
  copy(imu.angular_rate_radps, wire.angular_rate_radps);
  copy(imu.acceleration_mps2, wire.acceleration_mps2);
  wire.angular_rate_variance = imu.angular_rate_variance;
  wire.acceleration_variance = imu.acceleration_variance;
  wire.roll_rad = imu.roll_rad;
  wire.pitch_rad = imu.pitch_rad;
  wire.yaw_rad = imu.yaw_rad;
  wire.orientation_variance = imu.orientation_variance;
  wire.has_orientation = imu.has_orientation ? 1 : 0;
  return wire;
}

pose::Imu from_wire(imu_t&& wire) {
  if (wire.has_orientation != 0 && wire.has_orientation != 1) {
    throw std::range_error("has_orientation = " + std::to_string(wire.has_orientation));
  }
  pose::Imu imu;
  imu.utime = wire.utime;
  imu.seq = wire.seq;
  copy(wire.angular_rate_radps, imu.angular_rate_radps);
  copy(wire.acceleration_mps2, imu.acceleration_mps2);
  imu.angular_rate_variance = wire.angular_rate_variance;
  imu.acceleration_variance = wire.acceleration_variance;
  imu.roll_rad = wire.roll_rad;
  imu.pitch_rad = wire.pitch_rad;
  imu.yaw_rad = wire.yaw_rad;
  imu.orientation_variance = wire.orientation_variance;
  imu.has_orientation = wire.has_orientation == 1;
  return imu;
}

trajectory_t to_wire(const pose::TrajectoryPage& page) {
  trajectory_t wire;
  wire.utime = page.utime;
  wire.seq = page.seq;
  wire.num_poses = static_cast<std::int32_t>(page.poses.size());
  wire.revision = page.revision;
  wire.page = page.page;
  wire.num_pages = page.num_pages;
  wire.poses.resize(page.poses.size());
  for (std::size_t i = 0; i < page.poses.size(); ++i) {
    wire.poses[i].utime = page.poses[i].utime;
    wire.poses[i].x_m = page.poses[i].x_m;
    wire.poses[i].y_m = page.poses[i].y_m;
    wire.poses[i].yaw_rad = page.poses[i].yaw_rad;
    copy(page.poses[i].covariance, wire.poses[i].covariance);
  }
  return wire;
}

pose::TrajectoryPage from_wire(trajectory_t&& wire) {
  pose::TrajectoryPage page;
  page.utime = wire.utime;
  page.seq = wire.seq;
  page.revision = wire.revision;
  page.page = wire.page;
  page.num_pages = wire.num_pages;
  page.poses.resize(wire.poses.size());
  for (std::size_t i = 0; i < wire.poses.size(); ++i) {
    page.poses[i].utime = wire.poses[i].utime;
    page.poses[i].x_m = wire.poses[i].x_m;
    page.poses[i].y_m = wire.poses[i].y_m;
    page.poses[i].yaw_rad = wire.poses[i].yaw_rad;
    copy(wire.poses[i].covariance, page.poses[i].covariance);
  }
  return page;
}

}  // namespace orchard::bus
