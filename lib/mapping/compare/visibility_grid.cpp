// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/visibility_grid.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "geometry/visibility.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr double kViewStep_m = 0.5;  ///< min distance between two views
constexpr double kTurn_rad = 0.15;   ///< or min rotation between them
constexpr int kNumBearings = 1440;   ///< 0.25 degrees: a trunk of 0.1 m at 20 m covers one
constexpr double kBehind_m = 0.5;    ///< distance behind an object that still belongs to it

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
