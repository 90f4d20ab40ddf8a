// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/look.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "evaluation/assignment.hpp"

namespace orchard::evaluation {
namespace {

using detection::Detection;
using detection::Detections;
using simulation::TrueObservation;

/// The rigid motion from base to laser.
struct Mount {
  double c = 1.0, s = 0.0, x_m = 0.0, y_m = 0.0;
  Point to_laser(double x_base_m, double y_base_m) const {
    const double dx = x_base_m - x_m, dy = y_base_m - y_m;
    return {c * dx + s * dy, -s * dx + c * dy};
  }
};

Point surface_in_laser(const Detection& d) {
  return {d.range_m * std::cos(d.bearing_rad), d.range_m * std::sin(d.bearing_rad)};
}

/// Least squares over all surface points; with fewer than two apart, the laser stands at base.
Mount mount_of(const std::vector<Detections>& messages) {
  double n = 0, lx = 0, ly = 0, bx = 0, by = 0;
  for (const Detections& message : messages) {
    for (const Detection& d : message.trunks) {
      const Point laser = surface_in_laser(d);
      n += 1, lx += laser.x_m, ly += laser.y_m, bx += d.surface_x_m, by += d.surface_y_m;
    }
  }
  if (n < 2) return {};
  lx /= n, ly /= n, bx /= n, by /= n;
  double dot = 0, cross = 0;
  for (const Detections& message : messages) {
    for (const Detection& d : message.trunks) {
      const Point laser = surface_in_laser(d);
      const double ax = laser.x_m - lx, ay = laser.y_m - ly;
      const double cx = d.surface_x_m - bx, cy = d.surface_y_m - by;
      dot += ax * cx + ay * cy;
      cross += ax * cy - ay * cx;
    }
  }
  const double length = std::hypot(dot, cross);
  if (length < 1e-9) return {};
  Mount mount;
  mount.c = dot / length;
  mount.s = cross / length;
  mount.x_m = bx - (mount.c * lx - mount.s * ly);
  mount.y_m = by - (mount.s * lx + mount.c * ly);
  return mount;
}

Point axis_in_laser(const TrueObservation& t) {
  const double range_m = t.range_m + 0.5 * t.width_m;
  return {range_m * std::cos(t.bearing_rad), range_m * std::sin(t.bearing_rad)};
}

void match_scan(const Detections& message, const std::vector<const TrueObservation*>& truth,
                const Mount& mount, int recording, double gate_m, std::vector<Look>& looks) {
  std::vector<Point> true_points, found_points;
  for (const TrueObservation* t : truth) true_points.push_back(axis_in_laser(*t));
  for (const Detection& d : message.trunks) {
    found_points.push_back(mount.to_laser(d.centre_x_m, d.centre_y_m));
  }
  const Assignment assignment = assign(true_points, found_points, gate_m);
  std::vector<char> used(found_points.size(), 0);
  Look look;
  look.recording = recording;
  look.scan_utime = message.utime;
  look.has_image = message.image_utime != 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    look.truth = *truth[i];
    look.detection.reset();
    look.centre_error_m = 0.0;
    if (assignment[i] != kUnmatched) {
      const auto k = static_cast<std::size_t>(assignment[i]);
      used[k] = 1;
      look.detection = message.trunks[k];
      look.detection_index = k;
      look.centre_error_m = std::hypot(found_points[k].x_m - true_points[i].x_m,
                                       found_points[k].y_m - true_points[i].y_m);
    }
    looks.push_back(look);
  }
  look.truth.reset();
  look.centre_error_m = 0.0;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k]) continue;
    look.detection = message.trunks[k];
    look.detection_index = k;
    looks.push_back(look);
  }
}

}  // namespace

Looks match_looks(const std::vector<Detections>& messages,
                  const std::vector<TrueObservation>& truth, int recording,
                  const LookRules& rules) {
  std::map<std::int64_t, std::vector<const TrueObservation*>> by_scan;
  for (const TrueObservation& t : truth) {
    auto& scan = by_scan[t.utime];
    if (t.num_beams > 0) scan.push_back(&t);
  }
  const Mount mount = mount_of(messages);
  Looks result;
  std::set<std::int64_t> answered;
  for (const Detections& message : messages) {
    const auto scan = by_scan.find(message.utime);
    if (scan == by_scan.end() && !message.trunks.empty()) {
      ++result.num_without_truth;
      continue;
    }
    if (scan == by_scan.end() || !answered.insert(message.utime).second) continue;
    ++result.num_scans;
    match_scan(message, scan->second, mount, recording, rules.gate_m, result.looks);
  }
  result.num_without_message = static_cast<int>(by_scan.size() - answered.size());
  return result;
}

}  // namespace orchard::evaluation
