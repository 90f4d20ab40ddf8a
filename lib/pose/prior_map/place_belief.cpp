// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/place_belief.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <tuple>
#include <utility>

#include "geometry/statistics.hpp"
#include "geometry/symmetric.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {
namespace {

using geometry::square;

// derived: a Gaussian a little wider than a place is left whole, so that halves are not divided for
// ever. What is less probable is given up, and so is a belief in more places, a bound on the cost
// of a scan.
constexpr double kSplitVariances = 1.5;
constexpr double kImprobable = 1e-8;
constexpr std::size_t kPlacesMax = 8'000;

// derived: a bound on the cost until most of the cells are given up, a minute of one core: those of
// some hundred trees.
constexpr std::size_t kStartsMax = 200'000;

// derived: a start that is stated wrongly is off by a row or two, a motion that scans could not
// confirm by a plant, as scans along a row fit one plant farther, too. One in ten of both is: a
// place keeps its lead then, but neighbours come up within a few trunks.
constexpr double kMistaken = 0.1;
constexpr double kMisstatedSpacings = 2.0;
constexpr double kMismatchedSpacings = 1.0;

// derived: travel between corrections [m], a tenth of the way on which a trunk is in view; between
// them base moves unseen by less than a landmark's own error, and turns as that moves a trunk at
// two metres.
constexpr double kCorrectionInterval_m = 0.3;
constexpr double kSpread_m = 0.5 * PriorMapConfig::kLandmarkSd_m;
constexpr double kSpread_rad = 0.5 * kSpread_m;

/// Several weighted Gaussians as one.
class Moments {
 public:
  explicit Moments(const Eigen::Vector3d& around) : around_(around) {}

  void add(const WeighedPlace& place) {
    const Eigen::Vector3d d = pose_difference(place.T_map_base, around_);
    sum_ += place.weight;
    seen_ += place.weight * place.seen;
    expected_ += place.weight * place.expected;
    mean_ += place.weight * d;
    moment_ += place.weight * (place.covariance + d * d.transpose());
  }
  double sum() const { return sum_; }
  WeighedPlace place() const {
    return {stepped(around_, mean_ / sum_),
            moment_ / sum_ - mean_ * mean_.transpose() / (sum_ * sum_), sum_, seen_ / sum_,
            expected_ / sum_};
  }

 private:
  Eigen::Vector3d around_;
  double sum_ = 0.0, seen_ = 0.0, expected_ = 0.0;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment_ = Eigen::Matrix3d::Zero();
};

}  // namespace

PlaceBelief::PlaceBelief(const PriorMap& map)
    : map_(map),
      likelihood_(map),
      place_sd_m_(likelihood_.place_sd_m()),
      place_sd_rad_(likelihood_.place_sd_rad()),
      pattern_(map, likelihood_) {}

void PlaceBelief::start(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance) {
  places_ = {{T_map_base, covariance}};
  begin(kPlacesMax);
}

void PlaceBelief::start_stated(const Eigen::Vector3d& T_map_base,
                               const Eigen::Matrix3d& covariance) {
  start(T_map_base, covariance);
  doubt(kMisstatedSpacings);
  place_.weight = places_.front().weight;
}

/// Each place may be off by some spacings.
void PlaceBelief::doubt(double spacings) {
  const double off_m2 = square(spacings * map_.spacing_m());
  const std::size_t num = places_.size();
  for (std::size_t i = 0; i < num; ++i) {
    WeighedPlace off = places_[i];
    places_[i].weight *= 1.0 - kMistaken;
    off.weight *= kMistaken;
    if (off.weight < kImprobable) continue;
    off.covariance.diagonal() += Eigen::Vector3d(off_m2, off_m2, 0.0);
    places_.push_back(off);
  }
}

bool PlaceBelief::start_anywhere(double reach_m) {
  const double step_m = 2.0 * place_sd_m_, step_rad = 2.0 * place_sd_rad_;
  const int num_headings = static_cast<int>(std::ceil(2.0 * geometry::kPi / step_rad));
  const int reach = static_cast<int>(std::ceil(reach_m / step_m));
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
      Eigen::Vector3d(square(place_sd_m_), square(place_sd_m_), square(place_sd_rad_)).asDiagonal();
  const double weight = 1.0 / (1.0 * num_headings * static_cast<double>(cells.size()));
  places_.clear();
  for (const auto& [x, y] : cells) {
    for (int k = 0; k < num_headings; ++k) {
      const double yaw_rad = geometry::wrap_angle_rad(2.0 * geometry::kPi * k / num_headings);
      places_.push_back({{(x + 0.5) * step_m, (y + 0.5) * step_m, yaw_rad}, P, weight});
    }
  }
  begin(kStartsMax);
  return true;
}

void PlaceBelief::begin(std::size_t places_max) {
  place_ = places_.front();
  places_max_ = places_max;
  travel_m_ = 0.0;
  since_ = {};
  is_motion_doubted_ = false;
  pattern_.clear();
}

void PlaceBelief::move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance,
                       double travel_m) {
  travel_m_ += travel_m;
  since_.move(T_base_next, covariance);
  place_.move(T_base_next, covariance);
}

void PlaceBelief::move_places() {
  if (is_motion_doubted_) doubt(kMismatchedSpacings);
  is_motion_doubted_ = false;
  const Eigen::Vector3d spread(square(kSpread_m), square(kSpread_m), square(kSpread_rad));
  for (WeighedPlace& place : places_) {
    place.move(since_.T_map_base, since_.covariance);
    place.covariance.diagonal() += spread;
  }
  pattern_.move(since_.T_map_base, since_.covariance);
  travel_m_ = 0.0;
  since_ = {};
}

bool PlaceBelief::correct(const std::vector<ScanObservation>& observations,
                          const FieldOfView& field) {
  if (travel_m_ < kCorrectionInterval_m || field.range_m() <= 0.0) return false;
  const double share = std::min(1.0, travel_m_ / (2.0 * field.range_m()));
  PlaceLikelihood::ScanView scan(observations, field);
  move_places();
  pattern_.add(place_, scan, share);
  split();
  std::vector<double> log_weights;
  for (WeighedPlace& place : places_) {
    const double log_likelihood = likelihood_.correct(place, scan, share);
    log_weights.push_back(std::log(place.weight) + share * log_likelihood);
  }
  const double most = *std::max_element(log_weights.begin(), log_weights.end());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    places_[i].weight = std::exp(log_weights[i] - most);
  }
  merge();
  prune();
  if (!likelihood_.are_near(places_.front().T_map_base, place_.T_map_base)) pattern_.clear();
  place_ = sum_around(places_.front().T_map_base);
  return true;
}

void PlaceBelief::split() {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    while (places_.size() < 2 * places_max_ && split(i)) continue;
  }
}

/// Divides a Gaussian that is wider than a place into three along its longest axis, with the same
/// mean and covariance. False if it is not.
bool PlaceBelief::split(std::size_t i) {
  WeighedPlace& place = places_[i];
  const geometry::Axes2 axes = geometry::axes_of(place.covariance.topLeftCorner<2, 2>());
  const double heading_m2 = place.covariance(2, 2) * square(place_sd_m_ / place_sd_rad_);
  if (std::max(axes.values(1), heading_m2) <= kSplitVariances * square(place_sd_m_)) return false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  if (axes.values(1) > heading_m2) axis << axes.directions.col(1), 0.0;
  const Eigen::Vector3d along = place.covariance * axis;
  const Eigen::Vector3d step = along / std::sqrt(axis.dot(along));
  place.covariance -= 0.5 * step * step.transpose();
  place.weight *= 0.5;
  const WeighedPlace before{stepped(place.T_map_base, -step), place.covariance, 0.5 * place.weight};
  const WeighedPlace after{stepped(place.T_map_base, step), place.covariance, 0.5 * place.weight};
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
                       static_cast<int>(std::floor(T.z() / (2.0 * place_sd_rad_))), i);
  }
  std::sort(order.begin(), order.end());
  const auto same = [](const Cell& a, const Cell& b) {
    return std::get<0>(a) == std::get<0>(b) && std::get<1>(a) == std::get<1>(b) &&
           std::get<2>(a) == std::get<2>(b);
  };
  std::vector<WeighedPlace> joined;
  for (auto begin = order.begin(), end = begin; begin != order.end(); begin = end) {
    Moments moments(places_[std::get<3>(*begin)].T_map_base);
    for (; end != order.end() && same(*end, *begin); ++end) {
      moments.add(places_[std::get<3>(*end)]);
    }
    if (moments.sum() > 0.0) joined.push_back(moments.place());
  }
  places_ = std::move(joined);
}

/// Makes the weights probabilities, the greatest first, and gives up what is too improbable.
void PlaceBelief::prune() {
  std::stable_sort(
      places_.begin(), places_.end(),
      [](const WeighedPlace& a, const WeighedPlace& b) { return a.weight > b.weight; });
  double sum = 0.0;
  for (const WeighedPlace& place : places_) sum += place.weight;
  for (WeighedPlace& place : places_) place.weight /= sum;
  while (places_.back().weight < kImprobable) places_.pop_back();
}

WeighedPlace PlaceBelief::sum_around(const Eigen::Vector3d& T_map_base) const {
  Moments moments(T_map_base);
  for (const WeighedPlace& place : places_) {
    if (likelihood_.are_near(place.T_map_base, T_map_base)) moments.add(place);
  }
  return moments.place();
}

double PlaceBelief::probability_at(const Eigen::Vector3d& T_map_base) const {
  double sum = 0.0;
  for (const WeighedPlace& place : places_) {
    if (likelihood_.are_near(place.T_map_base, T_map_base)) sum += place.weight;
  }
  return sum;
}

bool PlaceBelief::is_spread_out() const {
  // Between corrections, the cells within three standard deviations.
  const Eigen::Matrix3d& P = place_.covariance;
  const double area = 9.0 * geometry::kPi * std::sqrt(P.topLeftCorner<2, 2>().determinant());
  const double headings = std::min(geometry::kPi, 3.0 * std::sqrt(P(2, 2))) / place_sd_rad_;
  const double num = area / square(2.0 * place_sd_m_) * std::max(1.0, headings);
  return places_.size() > places_max_ || !(num <= 1.0 * static_cast<double>(places_max_));
}

}  // namespace orchard::pose
