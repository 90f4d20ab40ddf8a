// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/displaced_fixes.hpp"

#include <cstdint>
#include <optional>
#include <vector>

#include "pose/filter/fix_hypotheses.hpp"
#include "pose/graph/georeference.hpp"
#include "pose/graph/receiver_model.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

/// Prior variance of the map's distance from the receiver's frame per axis [m2]: a multiple of the
/// receiver's own, which has placed the map.
constexpr double kMapVariance = 4.0;

/// Variance of the turn of a robot that stands [rad2].
constexpr double kStandingYawVariance = 1e-12;

}  // namespace

void mark_displaced(const std::vector<DisplacedTime>& displaced, SlamGraph& graph) {
  auto time = displaced.begin();
  for (Keyframe& keyframe : graph.keyframes) {
    for (AbsolutePosition& position : keyframe.positions) {
      while (time != displaced.end() && time->end_utime < position.utime) ++time;
      position.is_displaced = time != displaced.end() && time->begin_utime <= position.utime &&
                              time->is_gnss == position.is_gnss;
    }
  }
}

void mark_displaced_fixes(SlamGraph& graph) {
  if (!graph.georeferenced) return;
  const ReceiverModel receiver = estimate_receiver_model(graph);
  FixHypotheses hypotheses{FusionConfig{}};
  std::optional<std::int64_t> before;
  for (const Keyframe& k : graph.keyframes) {
    for (const AbsolutePosition& position : k.positions) {
      if (position.receiver_error < 0 || (before && position.utime < *before)) continue;
      const double claimed = per_axis_variance(position);
      for (FixHypotheses::Hypothesis& h : hypotheses.all()) {
        h.filter.set_receiver_variance(receiver.correlated * claimed);
      }
      if (!before) {
        Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
        P.diagonal() << kMapVariance * claimed, kMapVariance * claimed, kStandingYawVariance;
        hypotheses.place(Eigen::Vector3d::Zero(), P, position.utime, true);
      } else {
        MotionStep stands;
        stands.dt_s = timing::seconds(position.utime - *before);
        hypotheses.move(stands);
      }
      before = position.utime;
      PositionObservation distance;
      distance.p_map_m = position.p_map - p_by_path(k, position);
      distance.covariance = receiver.noise * position.covariance;
      distance.is_gnss = true;
      hypotheses.correct(distance, position.utime);
    }
  }
  mark_displaced(hypotheses.best().histories.likeliest(), graph);
}

}  // namespace orchard::pose
