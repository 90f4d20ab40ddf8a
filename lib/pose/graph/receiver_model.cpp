// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/receiver_model.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "geometry/statistics.hpp"
#include "pose/gnss_config.hpp"
#include "pose/graph/factors.hpp"
#include "pose/graph/georeference.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
using geometry::square;

namespace {

/// Max duration of a step between fixes whose error is attributed to the receiver alone [s].
constexpr double kStep_s = 2.0;

constexpr std::size_t kStepsMin = 20;

/// Weight of the claimed variance, in independent fixes: a unit information prior (Kass and
/// Wasserman 1995).
constexpr double kClaimWeight = 1.0;

/// A larger error is reported, in claimed standard deviations.
constexpr double kWorthSaying = 2.0;

/// Mean distance of the fixes that share one correlated error from the path.
struct MeanDistance {
  Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
  int num = 0;
};

}  // namespace

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
      MeanDistance& d = distances[static_cast<std::size_t>(position.receiver_error)];
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
