// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/fix_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "geometry/symmetric.hpp"
#include "pose/graph/georeference.hpp"
#include "pose/motion.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

// derived: a less likely history would move the mean path by less than a fiftieth of its distance
// from it; the path is solved once for each.
constexpr double kProbabilityMin = 0.02;
constexpr std::size_t kHistoriesMax = 6;

// physical: a vehicle passes a wall or a tree that reflects a signal within seconds, the signal's
// additional path is a fraction of a chip of 293 m (Kaplan and Hegarty 2006, section 6.2), and a
// larger one found is its own scale. How often is a weak Beta prior, in looks, so that a drive
// under open sky or between walls soon has its own.
constexpr double kDisplacedFor_s = 10.0;
constexpr double kDisplacedSd_m = 10.0;
constexpr double kDisplacedLooks = 1.0;
constexpr double kLooks = 20.0;

// physical: in this travel the wheels err once beyond what the filter models, as a tyre loses air;
// they then turn by as much per metre as the filter's prior allows. In this time the receiver's
// reference moves once, and the robot is carried once: as far as a displacement, but for good.
constexpr double kSlipEvery_m = 1000.0;
constexpr double kSlipCurvature_per_m = 0.02;
constexpr double kSlipYaw_rad = 0.5;  // at most
constexpr double kMovedEvery_s = 5e3;

// derived: a direct position within four standard deviations needs no such explanation; hypotheses
// with less than a millionth of the best's weight are dropped, those whose poses differ by less
// than a third of a standard deviation are one; their number bounds the time of a fix.
constexpr double kMoved_sigma = 4.0;
constexpr std::size_t kHypothesesMax = 48;
constexpr double kLogWeightMin = -14.0;
constexpr double kSame2 = 0.1;

// Headings of a split. derived: with half a slot as standard deviation, linearising the heading
// adds 0.75 (pi / 8)^2, a ninth, to the variance of a fix by the time that fixes give the heading
// as well; and equal Gaussians two standard deviations apart are uniform to 2 %. kUniform: the
// variance of a heading of which nothing is known [rad2].
constexpr int kHeadings = 8;
constexpr double kSlot_rad = 2.0 * geometry::kPi / kHeadings;
constexpr double kUniform = geometry::kPi * geometry::kPi / 3.0;

enum class Event { kGoesOn, kBegins, kEnds, kMoves };

struct Branch {
  std::size_t parent = 0;
  Event event = Event::kGoesOn;
  double log_weight = 0.0;
  double variance = 0.0;      ///< of the displacement, or of the unmeasured motion [m2]
  double yaw_variance = 0.0;  ///< of the unmeasured turn [rad2]
};

/// Returns the mean fraction of displaced positions that a history has shown.
double displaced_fraction(const FixHypotheses::Hypothesis& h) {
  return (kDisplacedLooks + h.displaced_looks) / (kLooks + h.looks);
}

bool are_same(const FixHypotheses::Hypothesis& a, const FixHypotheses::Hypothesis& b) {
  if (a.is_displaced != b.is_displaced) return false;
  if (a.is_displaced && a.displaces_gnss != b.displaces_gnss) return false;
  Eigen::Vector3d off = b.filter.mean().head<3>() - a.filter.mean().head<3>();
  off.z() = geometry::wrap_angle_rad(off.z());
  const Eigen::Matrix3d P = a.filter.covariance().topLeftCorner<3, 3>();
  return off.dot(geometry::solve_symmetric(P, off)) < kSame2;
}

/// Splits a hypothesis with an uncorrelated heading into several, if it is wider than a slot.
void split_heading(FixHypotheses::Hypothesis h, std::vector<FixHypotheses::Hypothesis>& out) {
  const double yaw_rad = h.filter.mean().z(), yaw_variance = h.filter.covariance()(2, 2);
  if (yaw_variance <= geometry::square(kSlot_rad)) {
    out.push_back(std::move(h));
    return;
  }
  // The mean first: of equals it is the likeliest.
  std::vector<double> offs_rad, log_densities;
  double sum = 0.0;
  for (int i = 0; i < kHeadings; ++i) {
    offs_rad.push_back(kSlot_rad * (i % 2 == 0 ? -(i / 2) : i / 2 + 1));
    log_densities.push_back(
        yaw_variance < kUniform ? -0.5 * geometry::square(offs_rad.back()) / yaw_variance : 0.0);
    sum += std::exp(log_densities.back());
  }
  for (std::size_t i = 0; i < offs_rad.size(); ++i) {
    FixHypotheses::Hypothesis heading = h;
    heading.filter.set_heading(yaw_rad + offs_rad[i], geometry::square(0.5 * kSlot_rad));
    heading.log_weight += log_densities[i] - std::log(sum);
    out.push_back(std::move(heading));
  }
}

// derived: prior variance of the map's distance from the receiver's frame per axis, as a multiple
// of the receiver's own, which has placed the map; and of the turn of a robot that stands [rad2].
constexpr double kMapVariance = 4.0;
constexpr double kStandingYawVariance = 1e-12;

}  // namespace

void DisplacementHistories::begin(std::int64_t utime, bool is_gnss) {
  for (DisplacementHistory& history : all_) history.displaced.push_back({utime, utime, is_gnss});
}

void DisplacementHistories::extend(std::int64_t utime) {
  for (DisplacementHistory& history : all_) history.displaced.back().end_utime = utime;
}

void DisplacementHistories::merge(const DisplacementHistories& other, double odds) {
  for (DisplacementHistory& history : all_) history.probability /= 1.0 + odds;
  for (const DisplacementHistory& history : other.all_) {
    const double probability = history.probability * odds / (1.0 + odds);
    const auto same = std::find_if(all_.begin(), all_.end(), [&](const DisplacementHistory& known) {
      return known.displaced == history.displaced;
    });
    if (same != all_.end()) {
      same->probability += probability;
    } else if (probability >= kProbabilityMin) {
      all_.push_back({probability, history.displaced});
    }
  }
  std::stable_sort(all_.begin(), all_.end(),
                   [](const DisplacementHistory& a, const DisplacementHistory& b) {
                     return a.probability > b.probability;
                   });
  while (all_.size() > 1 &&
         (all_.size() > kHistoriesMax || all_.back().probability < kProbabilityMin)) {
    all_.pop_back();
  }
  double sum = 0.0;
  for (const DisplacementHistory& history : all_) sum += history.probability;
  for (DisplacementHistory& history : all_) history.probability /= sum;
}

FixHypotheses::FixHypotheses(const FusionConfig& config) {
  all_.push_back({FusionFilter(config), 0.0, false, true, {}, 0.0, 0.0, 0.0});
}

double FixHypotheses::best_weight() const {
  double sum = 0.0;
  for (const Hypothesis& h : all_) sum += std::exp(h.log_weight - best().log_weight);
  return 1.0 / sum;
}

void FixHypotheses::move(const MotionStep& step) {
  for (Hypothesis& h : all_) {
    h.filter.move(step);
    h.travel_m += std::abs(step.speed_mps) * step.dt_s;
  }
  travel_m_ += std::abs(step.speed_mps) * step.dt_s;
}

void FixHypotheses::place(const Eigen::Vector3d& x_y_yaw, const Eigen::Matrix3d& covariance,
                          std::int64_t utime, bool is_gnss) {
  all_.resize(1, all_.front());
  Hypothesis& direct = all_.front();
  direct.filter.place(x_y_yaw, covariance);
  direct.filter.reset_receiver_error();
  const double fraction = displaced_fraction(direct);
  direct.log_weight = std::log(1.0 - fraction);
  Hypothesis displaced = direct;
  displaced.log_weight = std::log(fraction);
  displaced.is_displaced = true;
  displaced.displaces_gnss = is_gnss;
  displaced.histories.begin(utime, is_gnss);
  displaced.filter.inflate_covariance(geometry::square(kDisplacedSd_m), 0.0);
  displaced.filter.begin_displacement(geometry::square(kDisplacedSd_m));
  all_.push_back(std::move(displaced));
}

void FixHypotheses::start(const PositionObservation& observation, std::int64_t utime) {
  const double fix = observation.covariance.diagonal().maxCoeff() +
                     all_.front().filter.receiver_variance() + observation.p_base_m.squaredNorm();
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  P.diagonal() << fix, fix, kUniform;
  place({observation.p_map_m.x(), observation.p_map_m.y(), 0.0}, P, utime, observation.is_gnss);
  std::vector<Hypothesis> next;
  for (Hypothesis& h : all_) split_heading(std::move(h), next);
  all_ = std::move(next);
  position_utime_ = utime;
}

void FixHypotheses::split_unknown_headings(double variance) {
  std::vector<Hypothesis> next;
  for (Hypothesis& h : all_) {
    if (h.filter.decorrelate_unknown_heading(variance)) {
      split_heading(std::move(h), next);
    } else {
      next.push_back(std::move(h));
    }
  }
  std::stable_sort(next.begin(), next.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return a.log_weight > b.log_weight;
  });
  all_ = std::move(next);
}

void FixHypotheses::correct(const PositionObservation& observation, std::int64_t utime) {
  const double since_s =
      position_utime_ ? std::max(0.0, timing::seconds(utime - *position_utime_)) : 0.0;
  position_utime_ = utime;
  const double since_m = std::exchange(travel_m_, 0.0);
  PositionObservation direct = observation;
  direct.is_displaced = false;
  PositionObservation displaced = observation;
  displaced.is_displaced = true;

  std::vector<Branch> branches;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const Hypothesis& h = all_[i];
    // The chain forgets its state in the time of a displacement.
    const double fraction = displaced_fraction(h);
    const double forgotten = 1.0 - std::exp(-since_s / (kDisplacedFor_s * (1.0 - fraction)));
    const double begins = fraction * forgotten;
    const double ends = (1.0 - fraction) * forgotten;
    const bool other = h.is_displaced && h.displaces_gnss != observation.is_gnss;
    const auto add = [&](Event event, double probability, double log_likelihood, double variance,
                         double yaw_variance = 0.0) {
      if (probability <= 0.0) return;
      branches.push_back({i, event, h.log_weight + std::log(probability) + log_likelihood, variance,
                          yaw_variance});
    };
    const double as_direct = h.filter.log_likelihood(direct, 0.0);
    if (other) {  // of two sources, one at a time is displaced
      add(Event::kGoesOn, 1.0, as_direct, 0.0);
      continue;
    }
    const double off_m = h.filter.off_m(direct);
    const double variance = std::max(geometry::square(kDisplacedSd_m), geometry::square(off_m));
    add(Event::kBegins, begins, h.filter.log_likelihood(direct, variance), variance);
    if (h.is_displaced) {
      add(Event::kGoesOn, 1.0 - ends - begins, h.filter.log_likelihood(displaced, 0.0), 0.0);
      add(Event::kEnds, ends, as_direct, 0.0);
    } else {
      add(Event::kGoesOn, 1.0 - begins, as_direct, 0.0);
    }
    if (h.filter.mahalanobis2(direct) < geometry::square(kMoved_sigma)) continue;
    const double slip_rad = std::min(kSlipYaw_rad, kSlipCurvature_per_m * h.travel_m);
    const double slip2 = geometry::square(0.5 * slip_rad * h.travel_m);
    add(Event::kMoves, 1.0 - std::exp(-since_m / kSlipEvery_m),
        h.filter.log_likelihood(direct, slip2), slip2, geometry::square(slip_rad));
    const double moves = 1.0 - std::exp(-since_s / kMovedEvery_s);
    const double shift2 = geometry::square(off_m);
    add(Event::kMoves, moves, h.filter.log_likelihood(direct, shift2), shift2);
    add(Event::kMoves, moves, h.filter.log_likelihood(direct, variance), variance, kUniform);
  }
  std::stable_sort(branches.begin(), branches.end(),
                   [](const Branch& a, const Branch& b) { return a.log_weight > b.log_weight; });

  std::vector<Hypothesis> next;
  const double best = branches.front().log_weight;
  for (const Branch& branch : branches) {
    if (next.size() == kHypothesesMax || branch.log_weight < best + kLogWeightMin) break;
    Hypothesis h = all_[branch.parent];
    h.log_weight = branch.log_weight - best;
    switch (branch.event) {
      case Event::kGoesOn:
        break;
      case Event::kBegins:
        h.is_displaced = true;
        h.filter.begin_displacement(branch.variance);
        h.displaces_gnss = observation.is_gnss;
        h.histories.begin(utime, observation.is_gnss);
        break;
      case Event::kMoves:
        h.filter.inflate_covariance(branch.variance, branch.yaw_variance);
        [[fallthrough]];
      case Event::kEnds:
        h.is_displaced = false;
        h.filter.end_displacement();
        break;
    }
    const bool is_displaced = h.is_displaced && h.displaces_gnss == observation.is_gnss;
    const double look = 1.0 - std::exp(-since_s / kDisplacedFor_s);
    h.looks += look;
    if (is_displaced) {
      h.displaced_looks += look;
      h.histories.extend(utime);
    } else {
      h.travel_m = 0.0;
    }
    h.filter.correct(is_displaced ? displaced : direct);
    const auto same = std::find_if(next.begin(), next.end(),
                                   [&](const Hypothesis& other) { return are_same(other, h); });
    if (same == next.end()) {
      next.push_back(std::move(h));
    } else {
      const double odds = std::exp(h.log_weight - same->log_weight);
      same->histories.merge(h.histories, odds);
      same->log_weight += std::log1p(odds);
    }
  }
  std::stable_sort(next.begin(), next.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return a.log_weight > b.log_weight;
  });
  all_ = std::move(next);
}

std::vector<DisplacementHistory> FixHypotheses::histories() const {
  DisplacementHistories together = best().histories;
  double weight = 1.0;
  for (std::size_t i = 1; i < all_.size(); ++i) {
    const double added = std::exp(all_[i].log_weight - best().log_weight);
    together.merge(all_[i].histories, added / weight);
    weight += added;
  }
  return together.all();
}

PoseEstimate FixHypotheses::estimate(std::int64_t utime) const {
  const Eigen::Vector3d mean = best().filter.mean().head<3>();
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  for (const Hypothesis& h : all_) {
    Eigen::Vector3d off = h.filter.mean().head<3>() - mean;
    off.z() = geometry::wrap_angle_rad(off.z());
    const double weight = best_weight() * std::exp(h.log_weight - best().log_weight);
    P += weight * (h.filter.covariance().topLeftCorner<3, 3>() + off * off.transpose());
  }
  return pose_estimate(utime, mean, P);
}

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
