// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/visibility.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "geometry/visibility.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/tuning.hpp"
#include "pose/repeat_model.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// derived: the number of range bins.
constexpr std::size_t kNumRanges = VisibilityGrid::kRangeEnds_m.size();

using Rates = std::array<double, kNumRanges>;

/// Fits non-negative detection rates per distance bin to the observations per second of all trees
/// (least squares by coordinate descent: convex, few unknowns). Where the data do not separate
/// bins, the nearer one gets the rate.
Rates fit_rates(const std::vector<Rates>& fractions, const std::vector<double>& per_second) {
  // derived: enough to converge.
  constexpr int kSweeps = 300;
  Rates rates{};
  std::array<Rates, kNumRanges> products{};
  Rates targets{};
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    for (std::size_t j = 0; j < kNumRanges; ++j) {
      targets[j] += fractions[i][j] * per_second[i];
      for (std::size_t k = 0; k < kNumRanges; ++k)
        products[j][k] += fractions[i][j] * fractions[i][k];
    }
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t j = 0; j < kNumRanges; ++j) {
      if (products[j][j] <= 1e-9) continue;
      double rest = targets[j];
      for (std::size_t k = 0; k < kNumRanges; ++k) {
        if (k != j) rest -= products[j][k] * rates[k];
      }
      rates[j] = std::max(0.0, rest / products[j][j]);
    }
  }
  return rates;
}

}  // namespace

DetectionMap::DetectionMap(const std::vector<Landmark>& landmarks,
                           const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
                           const SensorView& view) {
  if (trajectories.empty()) return;
  is_known_ = true;
  raster_.emplace_back(landmarks, trajectories, view);
  std::vector<Rates> fractions;
  std::vector<double> per_second;
  for (const Landmark& l : landmarks) {
    if (l.label == detection::Label::kObject) continue;
    const VisibilityGrid::Seconds observations = raster_.front().at({l.x_m, l.y_m});
    double total_s = 0.0;
    for (const float s : observations) total_s += s;
    if (total_s <= 0.0) continue;
    Rates fraction{};
    for (std::size_t j = 0; j < kNumRanges; ++j) fraction[j] = observations[j] / total_s;
    fractions.push_back(fraction);
    per_second.push_back(l.num_observations / total_s);
  }
  num_mapped_min_ = view.min_observations;
  rate_per_s_ = fit_rates(fractions, per_second);
  std::vector<double> deviations;
  for (const Landmark& l : landmarks) {
    const double expected = expected_observations({l.x_m, l.y_m});
    if (l.label == detection::Label::kObject || expected < 3.0) continue;
    deviations.push_back(l.num_observations / expected - 1.0);
  }
  std::vector<double> visibilities = deviations;
  for (double& v : visibilities) v += 1.0;
  if (!visibilities.empty()) {
    clear_visibility_ =
        std::max(1e-3, geometry::quantile(std::move(visibilities), tuning::kSeenWell));
  }
  // Assume a relative spread of at least one half, even if a small map shows less.
  const double spread = deviations.empty() ? 1.0 : geometry::robust_sd(std::move(deviations));
  shape_ = std::clamp(1.0 / std::max(1e-6, spread * spread), 0.5, 4.0);
}

double DetectionMap::expected_observations(const Vector2d& p_map) const {
  if (!is_known_) return 0.0;
  const VisibilityGrid::Seconds observations = raster_.front().at(p_map);
  double sum = 0.0;
  for (std::size_t j = 0; j < kNumRanges; ++j) sum += observations[j] * rate_per_s_[j];
  return sum;
}

double DetectionMap::visibility(const Landmark& landmark) const {
  const double expected = expected_observations({landmark.x_m, landmark.y_m});
  if (expected <= 0.0) return 1.0;
  return std::clamp(landmark.num_observations / expected, 0.1, 1.0);
}

double DetectionMap::rate(const Landmark& landmark) const {
  const double chances = clear_visibility_ * expected_observations({landmark.x_m, landmark.y_m});
  if (chances <= 0.0) return 1.0;
  return pose::detection_rate(landmark.num_observations, chances);
}

double DetectionMap::probability_mapped(const Vector2d& p_map, double rate) const {
  if (!is_known_) return 1.0;
  const double chances = clear_visibility_ * expected_observations(p_map);
  return chances <= 0.0 ? 0.0 : pose::probability_seen_again(rate, num_mapped_min_ / chances);
}

double DetectionMap::probability_missed(const Vector2d& p_map, const DetectionMap& other,
                                        const Landmark& of_other) const {
  const double observed = 1.0 - probability_missed(p_map, other.visibility(of_other));
  return 1.0 - observed * probability_mapped(p_map, other.rate(of_other));
}

double DetectionMap::probability_missed(const Vector2d& p_map, double visibility) const {
  if (!is_known_) return 1.0;
  return std::pow(1.0 + visibility * expected_observations(p_map) / shape_, -shape_);
}

namespace {

constexpr double kViewStep_m = 0.5;  ///< derived: between two views: a cell (kCell_m)
constexpr double kTurn_rad = 0.15;   ///< derived: or such a turn: as far at 3 m
constexpr int kNumBearings = 1440;   ///< derived: 0.25 degrees: a trunk of 0.1 m at 20 m covers one
constexpr double kBehind_m = 0.5;    ///< derived: behind an object: the depth of a bush

struct View {
  Vector2d p_laser{0.0, 0.0};
  double yaw_rad = 0.0;
  double seconds = 0.0;
};

/// Selects spaced poses, each weighted by the time until the next. A long stop adds no viewpoints,
/// so it counts as ten ordinary steps at most.
std::vector<View> views_of(const std::vector<pose::PoseEstimate>& trajectory,
                           const SensorView& view) {
  std::vector<const pose::PoseEstimate*> kept;
  for (const pose::PoseEstimate& p : trajectory) {
    if (!kept.empty()) {
      const pose::PoseEstimate& last = *kept.back();
      const double turned_rad = geometry::wrap_angle_rad(p.yaw_rad - last.yaw_rad);
      if (std::hypot(p.x_m - last.x_m, p.y_m - last.y_m) < kViewStep_m &&
          std::abs(turned_rad) < kTurn_rad) {
        continue;
      }
    }
    kept.push_back(&p);
  }
  std::vector<double> seconds;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const std::int64_t end = i + 1 < kept.size() ? kept[i + 1]->utime : trajectory.back().utime;
    seconds.push_back(1e-6 * static_cast<double>(end - kept[i]->utime));
  }
  const double typical_s = std::max(1e-3, geometry::median(seconds));
  std::vector<View> views;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    View v;
    v.p_laser = transform(geometry::Pose2{kept[i]->x_m, kept[i]->y_m, kept[i]->yaw_rad},
                          {view.mount_x_m, view.mount_y_m});
    v.yaw_rad = kept[i]->yaw_rad + view.mount_yaw_rad;
    v.seconds = std::clamp(seconds[i], 0.1 * typical_s, 10.0 * typical_s);
    views.push_back(v);
  }
  return views;
}

std::size_t bearing_index(double bearing_rad) {
  const double turns = bearing_rad / (2.0 * geometry::kPi);
  const int index = static_cast<int>(std::floor((turns - std::floor(turns)) * kNumBearings));
  return static_cast<std::size_t>(std::min(index, kNumBearings - 1));
}

/// Free range from a point in every direction of the map.
std::vector<float> free_distance_m(const Vector2d& p, double reach_m,
                                   const geometry::IndexedPoints& things,
                                   const std::vector<double>& radius_m) {
  std::vector<float> free_m(kNumBearings, static_cast<float>(reach_m));
  for (const std::int32_t i : things.within(p, reach_m)) {
    const auto k = static_cast<std::size_t>(i);
    const auto [distance_m, bearing_rad, half_rad] =
        geometry::outline_of(things[k] - p, radius_m[k]);
    if (distance_m <= radius_m[k] + 0.05) continue;
    const double step_rad = 2.0 * geometry::kPi / kNumBearings;
    // Directions whose centre the object covers.
    const auto first = static_cast<int>(std::ceil((bearing_rad - half_rad) / step_rad - 0.5));
    const auto last = static_cast<int>(std::floor((bearing_rad + half_rad) / step_rad - 0.5));
    for (int b = first; b <= last; ++b) {
      float& f =
          free_m[static_cast<std::size_t>(((b % kNumBearings) + kNumBearings) % kNumBearings)];
      f = std::min(f, static_cast<float>(distance_m + kBehind_m));
    }
  }
  return free_m;
}

int cell_of(double coordinate_m) {
  return static_cast<int>(
      std::floor(std::clamp(coordinate_m, -5e8, 5e8) / VisibilityGrid::kCell_m));
}

/// Sets the range to 0 in directions outside the laser's field of view.
void close_behind(const SensorView& view, double yaw_rad, std::vector<float>& free_m) {
  const double middle_rad = yaw_rad + 0.5 * (view.bearing_min_rad + view.bearing_max_rad);
  const double half_rad = 0.5 * (view.bearing_max_rad - view.bearing_min_rad);
  for (int b = 0; b < kNumBearings; ++b) {
    const double bearing_rad = (b + 0.5) * 2.0 * geometry::kPi / kNumBearings;
    if (std::abs(geometry::wrap_angle_rad(bearing_rad - middle_rad)) > half_rad) {
      free_m[static_cast<std::size_t>(b)] = 0.0f;
    }
  }
}

}  // namespace

int VisibilityGrid::tile_of(int cell) {
  return cell >= 0 ? cell / kTileCells : -((-cell + kTileCells - 1) / kTileCells);
}

VisibilityGrid::VisibilityGrid(const std::vector<Landmark>& landmarks,
                               const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
                               const SensorView& view) {
  std::vector<Vector2d> places;
  std::vector<double> radius_m;
  for (const Landmark& l : landmarks) {
    places.push_back({l.x_m, l.y_m});
    radius_m.push_back(0.5 * l.width_m);
  }
  const geometry::IndexedPoints things(std::move(places));
  for (const auto& trajectory : trajectories) {
    for (const View& v : views_of(trajectory, view)) {
      std::vector<float> free_m = free_distance_m(v.p_laser, view.reach_m, things, radius_m);
      close_behind(view, v.yaw_rad, free_m);
      add_view(v.p_laser, view.reach_m, static_cast<float>(v.seconds), free_m);
    }
  }
}

void VisibilityGrid::add_view(const Vector2d& p_laser, double reach_m, float seconds,
                              const std::vector<float>& free_m) {
  const int x_first = cell_of(p_laser.x() - reach_m), x_last = cell_of(p_laser.x() + reach_m);
  const int y_last = cell_of(p_laser.y() + reach_m);
  Tile* tile = nullptr;
  int tx = 0, ty = 0;
  for (int y = cell_of(p_laser.y() - reach_m); y <= y_last; ++y) {
    for (int x = x_first; x <= x_last; ++x) {
      const Vector2d d = Vector2d((x + 0.5) * kCell_m, (y + 0.5) * kCell_m) - p_laser;
      const double distance_m = d.norm();
      if (distance_m > reach_m || distance_m > free_m[bearing_index(std::atan2(d.y(), d.x()))]) {
        continue;
      }
      const int wanted_x = tile_of(x), wanted_y = tile_of(y);
      if (tile == nullptr || wanted_x != tx || wanted_y != ty) {
        tx = wanted_x, ty = wanted_y;
        tile = &tiles_[{tx, ty}];
        if (tile->empty()) tile->assign(kTileCells * kTileCells, Seconds{});
      }
      const auto range = static_cast<std::size_t>(
          std::upper_bound(kRangeEnds_m.begin(), kRangeEnds_m.end() - 1, distance_m) -
          kRangeEnds_m.begin());
      (*tile)[static_cast<std::size_t>((y - ty * kTileCells) * kTileCells + (x - tx * kTileCells))]
             [range] += seconds;
    }
  }
}

VisibilityGrid::Seconds VisibilityGrid::at(const Vector2d& p_map) const {
  const int cx = cell_of(p_map.x()), cy = cell_of(p_map.y());
  const int tx = tile_of(cx), ty = tile_of(cy);
  const auto found = tiles_.find({tx, ty});
  if (found == tiles_.end()) return {};
  return found->second[static_cast<std::size_t>((cy - ty * kTileCells) * kTileCells +
                                                (cx - tx * kTileCells))];
}

}  // namespace orchard::mapping
