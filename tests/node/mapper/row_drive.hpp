// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "bus/node/node.hpp"
#include "geometry/angles.hpp"
#include "geometry/georeference.hpp"

namespace orchard::procs {

/// At 10 Hz past a row with a tree every two metres; scans at 40 Hz.
class RowDrive {
 public:
  explicit RowDrive(bus::Node& mapper) : mapper_(mapper) {}
  void step(
      int k, int pose_seq, const bus::Outbox& to = [](const bus::Message&) {}) {
    const std::int64_t utime = 1000000 + 100000 * k;
    for (int s = 0; s < 4; ++s) {
      laser::Scan scan;
      scan.utime = utime + 25000 * s;
      scan.seq = 4 * k + s;
      scan.bearing_min_rad = -1.5;
      scan.bearing_step_rad = 0.01;
      scan.beam_period_us = 20.0;
      scan.range_min_m = 0.1;
      scan.range_max_m = 30.0;
      scan.ranges_m.assign(301, 4.0f + 0.1f * static_cast<float>(k % 3));
      mapper_.handle(scan, to);
    }
    detection::Detections detections;
    detections.utime = utime;
    detections.seq = k;
    const double x_m = 0.1 * k;
    for (double tree_m = 2.0 * std::ceil(x_m / 2.0); tree_m < x_m + 6.0; tree_m += 2.0) {
      detection::Detection d;
      d.utime = utime;
      d.centre_x_m = tree_m - x_m + 0.003 * (k % 5);
      d.centre_y_m = 1.5 - 0.002 * (k % 7);
      d.covariance = {1e-4, 0, 1e-4};
      d.width_m = 0.1;
      d.width_sd_m = 0.01;
      d.label = k % 4 == 0 ? detection::Label::kObject : detection::Label::kTree;
      d.roc_tree = 0.7f;
      detections.trunks.push_back(d);
    }
    mapper_.handle(detections, to);
    pose::PoseEstimate pose;
    pose.utime = utime;
    pose.seq = pose_seq;
    pose.x_m = x_m;
    pose.covariance = {1e-4, 0, 0, 1e-4, 0, 1e-6};
    mapper_.handle(pose, to);
  }

 private:
  bus::Node& mapper_;
};

/// The antenna drives a circle of 20 m; the path that is told is a tenth too wide in one half.
inline void drive_beside_fixes(bus::Node& mapper) {
  const geometry::Georeference place{52.0, 5.0, 10.0, 0.0, 0.0, 0.0, 0.0};
  for (int k = 0; k < 300; ++k) {
    const double angle_rad = 2.0 * geometry::kPi * k / 300.0;
    const Eigen::Vector2d p(20.0 * std::cos(angle_rad), 20.0 * std::sin(angle_rad));
    pose::PoseEstimate pose;
    pose.utime = 1'000'000 + 100'000 * k;
    pose.seq = k;
    pose.x_m = p.x();
    pose.y_m = p.y() > 0.0 ? 1.1 * p.y() : p.y();
    mapper.handle(pose, [](const bus::Message&) {});
    const geometry::Geodetic at = geometry::geodetic_of(place, p);
    pose::Gnss gnss;
    gnss.utime = pose.utime;
    gnss.seq = k;
    gnss.fix_quality = 4;
    gnss.latitude_deg = at.latitude_deg;
    gnss.longitude_deg = at.longitude_deg;
    gnss.altitude_m = place.altitude_m;
    mapper.handle(gnss, [](const bus::Message&) {});
  }
}

}  // namespace orchard::procs
