// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/place_belief.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "geometry/symmetric.hpp"
#include "pose/motion.hpp"

namespace orchard::pose {
namespace {

using geometry::square;

// derived: fractions of the landmarks in view that are seen, alike likely; beyond this a landmark
// adds nothing to an observation; the radius in which observations are counted for the density of
// clutter [m], that of a plant with its shoots.
constexpr std::array<double, 5> kFractions{0.1, 0.3, 0.5, 0.7, 0.9};
constexpr double kReachSigmas = 3.5;
constexpr double kClutter_m = 1.0;

// derived: a Gaussian of a quarter of the spacing has one partner for a trunk, also if its heading
// errs by as much at two spacings; a little more than that is left whole, so that halves are not
// divided for ever. What is less probable is given up, and so is a belief in more places, a bound
// on the cost of a scan.
constexpr double kPlaceSpacings = 0.25;
constexpr double kPlaceSd_rad = 0.5 * kPlaceSpacings;
constexpr double kSplitVariances = 1.5;
constexpr double kImprobable = 1e-8;
constexpr std::size_t kPlacesMax = 8'000;

// derived: a robot that sees trunks is near some; and a bound on the cost of a scan until most of
// the cells are given up: those of some hundred trees.
constexpr double kStartSpacings = 1.5;
constexpr std::size_t kStartsMax = 100'000;

// derived: a start that is stated wrongly is off by a row or two.
constexpr double kMisstated = 0.1;
constexpr double kMisstatedSpacings = 2.0;

// derived: travel between corrections [m], a tenth of the way on which a trunk is in view; between
// them base moves unseen by less than a landmark's own error, and turns as that moves a trunk at
// two metres.
constexpr double kCorrectionInterval_m = 0.3;
constexpr double kSpread_m = 0.5 * PriorMapConfig::kLandmarkSd_m;
constexpr double kSpread_rad = 0.5 * kSpread_m;

Eigen::Vector3d difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Vector3d d = a - b;
  d.z() = geometry::wrap_angle_rad(d.z());
  return d;
}

/// Of a point at `arm_m` from base, in the axes of map, by base's pose.
Eigen::Matrix<double, 2, 3> jacobian(const Eigen::Vector2d& arm_m) {
  Eigen::Matrix<double, 2, 3> H;
  H << 1.0, 0.0, -arm_m.y(), 0.0, 1.0, arm_m.x();
  return H;
}

Eigen::Vector3d moved_by(const Eigen::Vector3d& T, const Eigen::Vector3d& step) {
  return {T.x() + step.x(), T.y() + step.y(), geometry::wrap_angle_rad(T.z() + step.z())};
}

void move_pose(Eigen::Vector3d& T, Eigen::Matrix3d& P, const Eigen::Vector3d& T_next,
               const Eigen::Matrix3d& P_next) {
  P = compose_covariance(T, P, T_next, P_next);
  T = geometry::compose(T, T_next);
  T.z() = geometry::wrap_angle_rad(T.z());
}

/// Several weighted Gaussians as one.
class Moments {
 public:
  explicit Moments(const Eigen::Vector3d& around) : around_(around) {}

  void add(const Eigen::Vector3d& T, const Eigen::Matrix3d& P, double weight, double seen,
           double expected) {
    const Eigen::Vector3d d = difference(T, around_);
    sum_ += weight;
    seen_ += weight * seen;
    expected_ += weight * expected;
    mean_ += weight * d;
    moment_ += weight * (P + d * d.transpose());
  }
  double sum() const { return sum_; }
  double seen() const { return seen_ / sum_; }
  double expected() const { return expected_ / sum_; }
  Eigen::Vector3d mean() const { return moved_by(around_, mean_ / sum_); }
  Eigen::Matrix3d covariance() const {
    return moment_ / sum_ - mean_ * mean_.transpose() / (sum_ * sum_);
  }

 private:
  Eigen::Vector3d around_;
  double sum_ = 0.0, seen_ = 0.0, expected_ = 0.0;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment_ = Eigen::Matrix3d::Zero();
};

}  // namespace

/// Products over the landmarks in view, one for each fraction of them that is seen.
class PlaceBelief::SeenAndMissed {
 public:
  SeenAndMissed() { products_.fill(1.0); }

  /// A landmark that another visit sees with probability `repeat`: `ratio` is the density of the
  /// observations as this landmark over that as clutter, 0 if it is missed.
  void add(double ratio, double repeat) {
    for (std::size_t i = 0; i < products_.size(); ++i) products_[i] *= factor(i, ratio, repeat);
  }
  double mean() const {
    double sum = 0.0;
    for (const double product : products_) sum += product;
    return sum / static_cast<double>(products_.size());
  }
  /// Probability that a partner with a `part` of the landmark's ratio is the landmark.
  double share_of(double part, double ratio, double repeat) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < products_.size(); ++i) {
      sum += products_[i] * kFractions[i] * repeat * part / factor(i, ratio, repeat);
    }
    return sum / (mean() * static_cast<double>(products_.size()));
  }

 private:
  static double factor(std::size_t i, double ratio, double repeat) {
    return 1.0 + kFractions[i] * repeat * (ratio - 1.0);
  }

  std::array<double, kFractions.size()> products_;
};

/// What a scan tells of a point of base: whether a trunk there would be in view, and how far the
/// nearest observation is. A raster, because thousands of places ask.
class PlaceBelief::ViewOfScan {
 public:
  ViewOfScan(const std::vector<ScanObservation>& observations, const FieldOfView& field)
      : range_m_(field.range_m()), half_(static_cast<int>(std::ceil(range_m_ / kCell_m))) {
    const geometry::OcclusionTest occlusion = occlusion_by(observations);
    for (int y = -half_; y <= half_; ++y) {
      for (int x = -half_; x <= half_; ++x) {
        const Eigen::Vector2d p_base(kCell_m * x, kCell_m * y);
        const bool in_view = field.covers(p_base) && !occlusion.occludes(p_base);
        nearest_m_.push_back(in_view ? distance_m(observations, p_base) : -1.0F);
      }
    }
  }

  double range_m() const { return range_m_; }

  /// Distance to the nearest observation [m]; negative where nothing is in view.
  double nearest_m(const Eigen::Vector2d& p_base) const {
    const int x = static_cast<int>(std::lround(p_base.x() / kCell_m));
    const int y = static_cast<int>(std::lround(p_base.y() / kCell_m));
    if (std::max(std::abs(x), std::abs(y)) > half_) return -1.0;
    return nearest_m_[static_cast<std::size_t>((y + half_) * (2 * half_ + 1) + x + half_)];
  }

 private:
  // derived: fine for two landmarks' errors.
  static constexpr double kCell_m = 2.0 * PriorMapConfig::kLandmarkSd_m;

  static float distance_m(const std::vector<ScanObservation>& observations,
                          const Eigen::Vector2d& p_base) {
    double d2 = std::numeric_limits<float>::max();
    for (const ScanObservation& s : observations) {
      d2 = std::min(d2, (s.p_base - p_base).squaredNorm());
    }
    return static_cast<float>(std::sqrt(d2));
  }

  double range_m_;
  int half_;
  std::vector<float> nearest_m_;
};

PlaceBelief::PlaceBelief(const PriorMap& map)
    : map_(map),
      place_sd_m_(kPlaceSpacings * map.spacing_m()),
      reach_m_(map.spacing_m()),
      grid_(2.0 * reach_m_) {
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(map.size()); ++i) {
    grid_.insert(i, map[i].p_map);
  }
}

void PlaceBelief::start(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance) {
  places_ = {{T_map_base, covariance, 1.0}};
  place_ = {T_map_base, covariance, 1.0};
  places_max_ = kPlacesMax;
  forget_motion();
}

void PlaceBelief::start_stated(const Eigen::Vector3d& T_map_base,
                               const Eigen::Matrix3d& covariance) {
  start(T_map_base, covariance);
  places_.front().weight = place_.probability = 1.0 - kMisstated;
  const double off_m2 = square(kMisstatedSpacings * map_.spacing_m());
  const Eigen::Vector3d off(off_m2, off_m2, 0.0);
  places_.push_back({T_map_base, covariance, kMisstated});
  places_.back().covariance.diagonal() += off;
}

bool PlaceBelief::start_anywhere() {
  const double step_m = 2.0 * place_sd_m_, step_rad = 2.0 * kPlaceSd_rad;
  const int num_headings = static_cast<int>(std::ceil(2.0 * geometry::kPi / step_rad));
  const int reach = static_cast<int>(std::ceil(kStartSpacings * map_.spacing_m() / step_m));
  std::set<std::pair<int, int>> cells;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(map_.size()); ++i) {
    const int x = static_cast<int>(std::floor(map_[i].p_map.x() / step_m));
    const int y = static_cast<int>(std::floor(map_[i].p_map.y() / step_m));
    for (int dx = -reach; dx <= reach; ++dx) {
      for (int dy = -reach; dy <= reach; ++dy) cells.emplace(x + dx, y + dy);
    }
    if (cells.size() * static_cast<std::size_t>(num_headings) > kStartsMax) return false;
  }
  const Eigen::Matrix3d P =
      Eigen::Vector3d(square(place_sd_m_), square(place_sd_m_), square(kPlaceSd_rad)).asDiagonal();
  const double weight = 1.0 / (1.0 * num_headings * static_cast<double>(cells.size()));
  places_.clear();
  for (const auto& [x, y] : cells) {
    for (int k = 0; k < num_headings; ++k) {
      const double yaw_rad = geometry::wrap_angle_rad(2.0 * geometry::kPi * k / num_headings);
      places_.push_back({{(x + 0.5) * step_m, (y + 0.5) * step_m, yaw_rad}, P, weight});
    }
  }
  place_ = {places_.front().T_map_base, P, weight};
  places_max_ = kStartsMax;
  forget_motion();
  return true;
}

void PlaceBelief::forget_motion() {
  travel_m_ = 0.0;
  T_then_now_.setZero();
  P_then_now_.setZero();
}

void PlaceBelief::move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance,
                       double travel_m) {
  travel_m_ += travel_m;
  move_pose(T_then_now_, P_then_now_, T_base_next, covariance);
  move_pose(place_.T_map_base, place_.covariance, T_base_next, covariance);
}

void PlaceBelief::move_places() {
  const Eigen::Vector3d spread(square(kSpread_m), square(kSpread_m), square(kSpread_rad));
  for (Gaussian& place : places_) {
    move_pose(place.T_map_base, place.covariance, T_then_now_, P_then_now_);
    place.covariance.diagonal() += spread;
  }
  forget_motion();
}

bool PlaceBelief::correct(const std::vector<ScanObservation>& observations,
                          const FieldOfView& field) {
  if (travel_m_ < kCorrectionInterval_m || field.range_m() <= 0.0) return false;
  const double travel_m = travel_m_;
  const double share = std::min(1.0, travel_m_ / (2.0 * field.range_m()));
  const std::vector<Target> targets = targets_of(observations);
  const ViewOfScan view(observations, field);
  move_places();
  split();
  std::vector<double> log_weights;
  for (Gaussian& place : places_) {
    const double log_likelihood = correct(place, targets, view, share);
    log_weights.push_back(std::log(place.weight) + share * log_likelihood);
  }
  const double most = *std::max_element(log_weights.begin(), log_weights.end());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    places_[i].weight = std::exp(log_weights[i] - most);
  }
  merge();
  prune();
  const Place last = place_;
  place_ = sum_around(places_.front().T_map_base);
  const bool is_held = is_near(places_.front(), last.T_map_base);
  place_.held_m = is_held ? last.held_m + travel_m : 0.0;
  return true;
}

std::vector<PlaceBelief::Target> PlaceBelief::targets_of(
    const std::vector<ScanObservation>& observations) const {
  // derived: the disc's area.
  constexpr double kAround_m2 = geometry::kPi * kClutter_m * kClutter_m;
  std::vector<Target> targets;
  for (const ScanObservation& s : observations) {
    const auto num_around = std::count_if(
        observations.begin(), observations.end(),
        [&](const auto& other) { return (other.p_base - s.p_base).norm() < kClutter_m; });
    targets.push_back({s.p_base, square(PriorMapConfig::kLandmarkSd_m) + 0.5 * s.covariance.trace(),
                       static_cast<double>(num_around) / kAround_m2});
  }
  return targets;
}

/// Appends the landmarks that the observation may be, if base is at the place.
void PlaceBelief::find_partners(const Gaussian& place, const Target& target,
                                std::vector<Partner>& partners) const {
  const Eigen::Vector2d arm_m = geometry::rotation(place.T_map_base.z()) * target.p_base;
  const Eigen::Vector2d p_map = place.T_map_base.head<2>() + arm_m;
  const Eigen::Matrix<double, 2, 3> H = jacobian(arm_m);
  const Eigen::Matrix2d C = H * place.covariance * H.transpose();
  // Where the place tells no trunk from the next, it learns nothing from one.
  if (0.5 * C.trace() > square(2.0 * place_sd_m_)) return;
  grid_.near(p_map.x(), p_map.y(), reach_m_, [&](std::int32_t i) {
    const Eigen::Vector2d offset_m = map_[i].p_map - p_map;
    if (offset_m.squaredNorm() > square(reach_m_)) return;
    const double variance_m2 = target.variance_m2 + square(map_[i].sd_m);
    const Eigen::Matrix2d S = C + variance_m2 * Eigen::Matrix2d::Identity();
    const double d2 = offset_m.dot(S.inverse() * offset_m);
    if (d2 > square(kReachSigmas)) return;
    const double density = std::exp(-0.5 * d2) / (2.0 * geometry::kPi * std::sqrt(S.determinant()));
    partners.push_back({arm_m, offset_m, variance_m2, i, density / target.clutter_per_m2});
  });
}

/// Returns all partners of all observations, sorted by landmark.
std::vector<PlaceBelief::Partner> PlaceBelief::partners_of(
    const Gaussian& place, const std::vector<Target>& targets) const {
  std::vector<Partner> partners;
  for (const Target& target : targets) find_partners(place, target, partners);
  std::stable_sort(partners.begin(), partners.end(),
                   [](const Partner& a, const Partner& b) { return a.landmark < b.landmark; });
  return partners;
}

/// Corrects a place by all partners of the landmarks, each with its probability. Returns the
/// logarithm of the likelihood.
double PlaceBelief::correct(Gaussian& place, const std::vector<Target>& targets,
                            const ViewOfScan& view, double share) const {
  const std::vector<Partner> partners = partners_of(place, targets);
  std::vector<double> ratios(partners.size(), 0.0);
  SeenAndMissed seen;
  double num_expected = 0.0, num_seen = 0.0;
  for (std::size_t begin = 0, end = 0; begin < partners.size(); begin = end) {
    const std::int32_t landmark = partners[begin].landmark;
    double ratio = 0.0;
    for (; end < partners.size() && partners[end].landmark == landmark; ++end) {
      ratio += partners[end].ratio;
    }
    std::fill(&ratios[begin], &ratios[begin] + (end - begin), ratio);
    seen.add(ratio, map_.repeat(landmark));
    num_expected += map_.repeat(landmark);
  }
  num_expected += add_missed(place, view, seen);
  Eigen::Matrix3d information = place.covariance.inverse();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < partners.size(); ++i) {
    const Partner& partner = partners[i];
    const double probability =
        seen.share_of(partner.ratio, ratios[i], map_.repeat(partner.landmark));
    num_seen += probability;
    const Eigen::Matrix<double, 2, 3> H = jacobian(partner.arm_m);
    information += share * probability / partner.variance_m2 * H.transpose() * H;
    gradient += share * probability / partner.variance_m2 * H.transpose() * partner.offset_m;
  }
  place.covariance = information.inverse();
  place.covariance = 0.5 * (place.covariance + place.covariance.transpose()).eval();
  place.T_map_base = moved_by(place.T_map_base, place.covariance * gradient);
  place.seen += share * (num_seen - place.seen);
  place.expected += share * (num_expected - place.expected);
  return std::log(seen.mean());
}

/// Adds the landmarks in view that no observation is near, and returns how many would be seen.
double PlaceBelief::add_missed(const Gaussian& place, const ViewOfScan& view,
                               SeenAndMissed& seen) const {
  const double place_m2 = 0.5 * place.covariance.topLeftCorner<2, 2>().trace() +
                          2.0 * square(PriorMapConfig::kLandmarkSd_m);
  double num = 0.0;
  map_.near(place.T_map_base.head<2>(), view.range_m(), [&](std::int32_t i) {
    const Eigen::Vector2d p_base = geometry::inverse_transform(place.T_map_base, map_[i].p_map);
    const double nearest_m = view.nearest_m(p_base);
    const double around_m2 =
        place_m2 + square(map_[i].sd_m) + 0.5 * place.covariance(2, 2) * p_base.squaredNorm();
    if (nearest_m < 0.0 || square(nearest_m) < square(kReachSigmas) * around_m2) return;
    seen.add(0.0, map_.repeat(i));
    num += map_.repeat(i);
  });
  return num;
}

void PlaceBelief::split() {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    while (places_.size() < 2 * places_max_ && split(i)) continue;
  }
}

/// Divides a Gaussian that is wider than a place into three along its longest axis, with the same
/// mean and covariance. False if it is not.
bool PlaceBelief::split(std::size_t i) {
  Gaussian& place = places_[i];
  const geometry::Axes2 axes = geometry::axes_of(place.covariance.topLeftCorner<2, 2>());
  const double heading_m2 = place.covariance(2, 2) * square(place_sd_m_ / kPlaceSd_rad);
  if (std::max(axes.values(1), heading_m2) <= kSplitVariances * square(place_sd_m_)) return false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  if (axes.values(1) > heading_m2) axis << axes.directions.col(1), 0.0;
  const Eigen::Vector3d along = place.covariance * axis;
  const Eigen::Vector3d step = along / std::sqrt(axis.dot(along));
  place.covariance -= 0.5 * step * step.transpose();
  place.weight *= 0.5;
  const Gaussian before{moved_by(place.T_map_base, -step), place.covariance, 0.5 * place.weight};
  const Gaussian after{moved_by(place.T_map_base, step), place.covariance, 0.5 * place.weight};
  places_.push_back(before);
  places_.push_back(after);
  return true;
}

/// Joins the Gaussians of a cell, which is as large as a place.
void PlaceBelief::merge() {
  using Cell = std::tuple<int, int, int, std::size_t>;
  std::vector<Cell> order;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Eigen::Vector3d& T = places_[i].T_map_base;
    order.emplace_back(static_cast<int>(std::floor(T.x() / (2.0 * place_sd_m_))),
                       static_cast<int>(std::floor(T.y() / (2.0 * place_sd_m_))),
                       static_cast<int>(std::floor(T.z() / (2.0 * kPlaceSd_rad))), i);
  }
  std::sort(order.begin(), order.end());
  const auto same = [](const Cell& a, const Cell& b) {
    return std::get<0>(a) == std::get<0>(b) && std::get<1>(a) == std::get<1>(b) &&
           std::get<2>(a) == std::get<2>(b);
  };
  std::vector<Gaussian> joined;
  for (auto begin = order.begin(), end = begin; begin != order.end(); begin = end) {
    Moments moments(places_[std::get<3>(*begin)].T_map_base);
    for (; end != order.end() && same(*end, *begin); ++end) {
      const Gaussian& place = places_[std::get<3>(*end)];
      moments.add(place.T_map_base, place.covariance, place.weight, place.seen, place.expected);
    }
    if (moments.sum() <= 0.0) continue;
    joined.push_back(
        {moments.mean(), moments.covariance(), moments.sum(), moments.seen(), moments.expected()});
  }
  places_ = std::move(joined);
}

/// Makes the weights probabilities, the greatest first, and gives up what is too improbable.
void PlaceBelief::prune() {
  std::stable_sort(places_.begin(), places_.end(),
                   [](const Gaussian& a, const Gaussian& b) { return a.weight > b.weight; });
  double sum = 0.0;
  for (const Gaussian& place : places_) sum += place.weight;
  for (Gaussian& place : places_) place.weight /= sum;
  while (places_.back().weight < kImprobable) places_.pop_back();
}

bool PlaceBelief::is_near(const Gaussian& place, const Eigen::Vector3d& T_map_base) const {
  const Eigen::Vector3d d = difference(place.T_map_base, T_map_base);
  return d.head<2>().norm() < 2.0 * place_sd_m_ && std::abs(d.z()) < 4.0 * kPlaceSd_rad;
}

PlaceBelief::Place PlaceBelief::sum_around(const Eigen::Vector3d& T_map_base) const {
  Moments moments(T_map_base);
  for (const Gaussian& place : places_) {
    if (!is_near(place, T_map_base)) continue;
    moments.add(place.T_map_base, place.covariance, place.weight, place.seen, place.expected);
  }
  return {moments.mean(), moments.covariance(), moments.sum(), moments.seen(),
          moments.seen() / std::max(1.0, moments.expected())};
}

double PlaceBelief::probability_at(const Eigen::Vector3d& T_map_base) const {
  double sum = 0.0;
  for (const Gaussian& place : places_) {
    if (is_near(place, T_map_base)) sum += place.weight;
  }
  return sum;
}

bool PlaceBelief::is_spread_out() const {
  // Between corrections, the cells within three standard deviations.
  const Eigen::Matrix3d& P = place_.covariance;
  const double area = 9.0 * geometry::kPi * std::sqrt(P.topLeftCorner<2, 2>().determinant());
  const double headings = std::min(geometry::kPi, 3.0 * std::sqrt(P(2, 2))) / kPlaceSd_rad;
  const double num = area / square(2.0 * place_sd_m_) * std::max(1.0, headings);
  return places_.size() > places_max_ || !(num <= 1.0 * static_cast<double>(places_max_));
}

}  // namespace orchard::pose
