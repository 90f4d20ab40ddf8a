// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/observation_pair.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "evaluation/assignment.hpp"
#include "geometry/rigid_fit2.hpp"

namespace orchard::evaluation {
namespace {

using detection::Detection;
using detection::Detections;
using simulation::TrueObservation;

Point surface_in_laser(const Detection& d) {
  return {d.range_m * std::cos(d.bearing_rad), d.range_m * std::sin(d.bearing_rad)};
}

/// Estimates T_base_laser by least squares over all surface points; identity when no two points are
/// apart.
geometry::Pose2 mount_of(const std::vector<Detections>& messages) {
  std::vector<Eigen::Vector2d> p_base, p_laser;
  for (const Detections& message : messages) {
    for (const Detection& d : message.trunks) {
      p_base.emplace_back(d.surface_x_m, d.surface_y_m);
      p_laser.push_back(surface_in_laser(d));
    }
  }
  if (p_base.size() < 2) return {};
  const geometry::RigidFit2 fit = geometry::fit_rigid(p_base, p_laser);
  return fit.mean_square_b_m2 < 1e-12 ? geometry::Pose2{} : fit.T_a_b;
}

Point axis_in_laser(const TrueObservation& t) {
  const double range_m = t.range_m + 0.5 * t.width_m;
  return {range_m * std::cos(t.bearing_rad), range_m * std::sin(t.bearing_rad)};
}

void match_scan(const Detections& message, const std::vector<const TrueObservation*>& truth,
                const geometry::Pose2& T_base_laser, int recording, double gate_m,
                std::vector<ObservationPair>& observations) {
  std::vector<Point> true_points, found_points;
  for (const TrueObservation* t : truth) true_points.push_back(axis_in_laser(*t));
  for (const Detection& d : message.trunks) {
    found_points.push_back(inverse_transform(T_base_laser, {d.centre_x_m, d.centre_y_m}));
  }
  const Assignment assignment = assign(true_points, found_points, gate_m);
  std::vector<char> used(found_points.size(), 0);
  ObservationPair observation;
  observation.recording = recording;
  observation.scan_utime = message.utime;
  observation.has_image = message.image_utime != 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    observation.truth = *truth[i];
    observation.detection.reset();
    observation.centre_error_m = 0.0;
    if (assignment[i] != kUnmatched) {
      const auto k = static_cast<std::size_t>(assignment[i]);
      used[k] = 1;
      observation.detection = message.trunks[k];
      observation.detection_index = k;
      observation.centre_error_m = std::hypot(found_points[k].x_m - true_points[i].x_m,
                                              found_points[k].y_m - true_points[i].y_m);
    }
    observations.push_back(observation);
  }
  observation.truth.reset();
  observation.centre_error_m = 0.0;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k]) continue;
    observation.detection = message.trunks[k];
    observation.detection_index = k;
    observations.push_back(observation);
  }
}

}  // namespace

ObservationPairs pair_observations(const std::vector<Detections>& messages,
                                   const std::vector<TrueObservation>& truth, int recording,
                                   const PairingRules& rules) {
  std::map<std::int64_t, std::vector<const TrueObservation*>> by_scan;
  for (const TrueObservation& t : truth) {
    auto& scan = by_scan[t.utime];
    if (t.num_beams > 0) scan.push_back(&t);
  }
  const geometry::Pose2 T_base_laser = mount_of(messages);
  ObservationPairs result;
  std::set<std::int64_t> answered;
  for (const Detections& message : messages) {
    const auto scan = by_scan.find(message.utime);
    if (scan == by_scan.end() && !message.trunks.empty()) {
      ++result.num_without_truth;
      continue;
    }
    if (scan == by_scan.end() || !answered.insert(message.utime).second) continue;
    ++result.num_scans;
    match_scan(message, scan->second, T_base_laser, recording, rules.gate_m, result.pairs);
  }
  result.num_without_message = static_cast<int>(by_scan.size() - answered.size());
  return result;
}

}  // namespace orchard::evaluation
