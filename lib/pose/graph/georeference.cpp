// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/georeference.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/pose2.hpp"
#include "geometry/rigid_fit2.hpp"
#include "geometry/statistics.hpp"
#include "pose/graph/factors.hpp"
#include "pose/pose_config.hpp"
#include "timing/units.hpp"

namespace orchard::pose {

using geometry::between;
using geometry::compose;
using geometry::compose_jacobian_second;
using geometry::rotation;
using geometry::square;
using geometry::transform;
namespace {

// derived: spread over six standard deviations, positions give a heading to a sixth of a radian,
// enough for the solver to converge; one of five may be an outlier by reflected signals.
constexpr std::size_t kNumPositionsMin = 4;
constexpr double kSpreadSigma = 6.0;
constexpr double kFitMin = 0.8;
constexpr int kRounds = 5;
// Fixes within this time share one receiver error [us]; derived: short against kReceiverMemory_s.
constexpr std::int64_t kReceiverErrorFor_us = 2'000'000;
// derived: a Gaussian fix is farther from the path once in two million.
constexpr double kLeftOut_sigma = 5.0;
// Steps between fixes show the receiver's noise; derived: short against kReceiverMemory_s, and so
// many that their median is known to a fifth.
constexpr double kStep_s = 2.0;
constexpr std::size_t kStepsMin = 20;
// Weight of the claimed variance, in independent fixes; derived: a unit information prior (Kass and
// Wasserman 1995). A variance beyond four times the claimed one is told.
constexpr double kClaimWeight = 1.0;
constexpr double kWorthSaying = 2.0;

/// Mean distance of the fixes that share one correlated error from the path.
struct MeanDistance {
  Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
  int num = 0;
};

}  // namespace

double per_axis_variance(const AbsolutePosition& position) {
  return 0.5 * position.covariance.trace();
}

Eigen::Vector2d p_by_path(const Keyframe& keyframe, const AbsolutePosition& position) {
  return transform(compose(keyframe.T_map_base, position.T_keyframe_then), position.lever_base_m);
}

std::optional<Eigen::Vector3d> find_georeference(const SlamGraph& graph, double travel_m) {
  std::vector<Eigen::Vector2d> p_graph, p_map;
  double sd_m = 0.0, reach_m = 0.0;
  const auto is_enough = [&] {
    return p_graph.size() >= kNumPositionsMin && reach_m >= std::max(travel_m, kSpreadSigma * sd_m);
  };
  for (auto k = graph.keyframes.rbegin(); k != graph.keyframes.rend() && !is_enough(); ++k) {
    for (auto position = k->positions.rbegin(); position != k->positions.rend(); ++position) {
      if (position->has_yaw) {
        const Eigen::Vector3d T_graph_then = compose(k->T_map_base, position->T_keyframe_then);
        Eigen::Vector3d T_map_then(0.0, 0.0, position->yaw_rad);
        T_map_then.head<2>() =
            position->p_map - rotation(position->yaw_rad) * position->lever_base_m;
        return compose(T_map_then, between(T_graph_then, Eigen::Vector3d::Zero()));
      }
      p_graph.push_back(p_by_path(*k, *position));
      p_map.push_back(position->p_map);
      sd_m = std::max(sd_m, std::sqrt(per_axis_variance(*position)));
      reach_m = std::max(reach_m, (p_graph.back() - p_graph.front()).norm());
    }
  }
  if (!is_enough()) return std::nullopt;
  const double off_most_m = 1.0 + 3.0 * sd_m;
  std::vector<double> weights(p_graph.size(), 1.0);
  geometry::RigidFit2 fit;
  std::size_t num_fit = 0;
  // Iteratively reweighted fit: outliers lose weight from round to round.
  for (int round = 0; round < kRounds; ++round) {
    fit = geometry::fit_rigid(p_map, p_graph, weights);
    num_fit = 0;
    for (std::size_t i = 0; i < p_graph.size(); ++i) {
      const double off_m = (transform(fit.T_a_b, p_graph[i]) - p_map[i]).norm();
      weights[i] = 1.0 / (1.0 + off_m * off_m / (off_most_m * off_most_m));
      if (off_m <= off_most_m) ++num_fit;
    }
  }
  if (static_cast<double>(num_fit) < kFitMin * static_cast<double>(p_graph.size())) {
    return std::nullopt;
  }
  return fit.T_a_b.vector();
}

void add_position(AbsolutePosition position, SlamGraph& graph) {
  std::vector<ReceiverError>& errors = graph.receiver_errors;
  if (position.is_gnss) {
    if (errors.empty() || position.utime - errors.back().utime >= kReceiverErrorFor_us) {
      ReceiverError fresh;
      fresh.utime = position.utime;
      fresh.claimed_variance = per_axis_variance(position);
      errors.push_back(fresh);
    }
    position.receiver_error = static_cast<int>(errors.size()) - 1;
  }
  graph.keyframes.back().positions.push_back(position);
}

RejectedFixes rejected_fixes(const SlamGraph& graph, bool of_receiver) {
  RejectedFixes all;
  std::int64_t since = 0;
  bool goes_on = false;
  for (const Keyframe& k : graph.keyframes) {
    for (const AbsolutePosition& position : k.positions) {
      if ((position.receiver_error >= 0) != of_receiver) continue;
      ++all.num_fixes;
      const Eigen::Vector2d off_m = position.p_map - p_by_path(k, position);
      const double error =
          of_receiver ? std::max(1.0, graph.receiver.noise + graph.receiver.correlated) : 1.0;
      const double variance = error * per_axis_variance(position);
      const bool contradicts = off_m.squaredNorm() > square(kLeftOut_sigma) * variance;
      if (!position.is_displaced) all.newest_contradicts = contradicts;
      if (!contradicts && !position.is_displaced) {
        goes_on = false;
        continue;
      }
      ++all.num_left_out;
      if (!position.is_displaced) ++all.num_contradicting;
      all.farthest_m = std::max(all.farthest_m, off_m.norm());
      if (!goes_on) since = position.utime;
      goes_on = true;
      all.longest_s = std::max(all.longest_s, 1e-6 * static_cast<double>(position.utime - since));
    }
  }
  return all;
}

std::string rejected_fixes_text(const RejectedFixes& left_out, bool of_receiver) {
  if (left_out.num_left_out == 0) return {};
  return fmt::format("{} of {} {} were rejected, with errors of up to {:.1f} m, for up to {:.1f} s",
                     left_out.num_left_out, left_out.num_fixes,
                     of_receiver ? "GNSS fixes" : "pose fixes", left_out.farthest_m,
                     left_out.longest_s);
}

void apply_georeference(const Eigen::Vector3d& T_map_graph, SlamGraph& graph) {
  const Eigen::Matrix3d F = compose_jacobian_second(T_map_graph);
  for (Keyframe& k : graph.keyframes) {
    k.T_map_base = compose(T_map_graph, k.T_map_base);
    k.covariance = F * k.covariance * F.transpose();
    k.calibration_cross = F * k.calibration_cross;
    k.local_covariance = F * k.local_covariance * F.transpose();
  }
  const Eigen::Matrix2d R = F.topLeftCorner<2, 2>();
  for (SlamLandmark& l : graph.landmarks) {
    l.p_map = transform(T_map_graph, l.p_map);
    l.information = R * l.information * R.transpose();
  }
  graph.older.forget();
  graph.georeferenced = true;
}

ReceiverModel estimate_receiver_model(const SlamGraph& graph) {
  ReceiverModel model;
  if (!graph.georeferenced) return model;
  std::vector<double> steps2;
  const AbsolutePosition* before = nullptr;
  Eigen::Vector2d p_before = Eigen::Vector2d::Zero();
  for (const Keyframe& k : graph.keyframes) {
    for (const AbsolutePosition& position : k.positions) {
      if (position.receiver_error < 0) continue;
      const Eigen::Vector2d p = p_by_path(k, position);
      if (before != nullptr && timing::seconds(position.utime - before->utime) <= kStep_s) {
        const Eigen::Vector2d off_m = (position.p_map - before->p_map) - (p - p_before);
        steps2.push_back(off_m.squaredNorm() /
                         (per_axis_variance(position) + per_axis_variance(*before)));
      }
      before = &position;
      p_before = p;
    }
  }
  if (steps2.size() < kStepsMin) return model;
  // For white noise the squared step is exponentially distributed: its median is ln 2 times its
  // mean.
  const double shown = geometry::median(steps2) / (2.0 * std::log(2.0));
  if (shown > 4.0) {
    model.noise = shown;
  } else {
    // The scatter is known to a few tenths only: count as correlated only what exceeds twice its
    // variance.
    model.claimed_correlated = std::max(0.0, 1.0 - 2.0 * shown);
    model.noise = 1.0 - model.claimed_correlated;
  }
  model.learnt_correlated = graph.receiver.learnt_correlated;
  model.correlated = model.learnt_correlated.value_or(model.claimed_correlated);
  return model;
}

double learnt_receiver_variance(const SlamGraph& graph, double claimed,
                                const std::vector<double>& variances) {
  std::vector<MeanDistance> distances(graph.receiver_errors.size());
  for (const Keyframe& k : graph.keyframes) {
    for (const AbsolutePosition& position : k.positions) {
      if (position.receiver_error < 0 || position.is_displaced) continue;
      MeanDistance& d = distances[position.receiver_error];
      d.sum_m += position.p_map - p_by_path(k, position);
      ++d.num;
    }
  }
  double sum = kClaimWeight * claimed, weights = kClaimWeight;
  const ReceiverError* before = nullptr;
  for (std::size_t e = 0; e < distances.size(); ++e) {
    const ReceiverError& now = graph.receiver_errors[e];
    const MeanDistance& d = distances[e];
    if (d.num == 0 || variances[e] < 0.0) continue;
    const double white = graph.receiver.noise / d.num;
    const double distance2 = (d.sum_m / d.num).squaredNorm() / now.claimed_variance;  // of two axes
    // What the error has not kept from the one before is independent of it.
    const double since_s = before != nullptr ? timing::seconds(now.utime - before->utime) : 1e9;
    const double fresh = 1.0 - std::exp(-2.0 * since_s / kReceiverMemory_s);
    const double expected = graph.receiver.correlated + white;
    const double weight = fresh / (1.0 + distance2 / (square(kOutlier_sigma) * expected));
    sum += weight * (0.5 * distance2 - white + variances[e] / now.claimed_variance);
    weights += weight;
    before = &now;
  }
  return std::max(0.0, sum / weights);
}

std::string receiver_text(const SlamGraph& graph) {
  const double shown = graph.receiver.noise + graph.receiver.learnt_correlated.value_or(0.0);
  if (graph.receiver_errors.empty() || shown <= square(kWorthSaying)) return {};
  const double claimed_m = std::sqrt(graph.receiver_errors.back().claimed_variance);
  return fmt::format(
      "GNSS errs by {:.2f} m per axis, more than the {:.2f} m that it states: it "
      "got less weight",
      std::sqrt(shown) * claimed_m, claimed_m);
}

}  // namespace orchard::pose
