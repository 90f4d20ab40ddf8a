// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/shadow_map.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"
#include "simulation/texture.hpp"

namespace orchard::simulation {
namespace {

constexpr double kCell_m = 0.04;
constexpr double kBeside_m = 6.0;         ///< margin of the grid around all objects
constexpr double kThinnest_m = 0.012;     ///< thinner objects are below the resolution of a cell
constexpr double kLongest_cotangent = 6;  ///< limit of the sun's elevation, about ten degrees

}  // namespace

ShadowMap::ShadowMap(const World& world, double sun_azimuth_rad, double sun_elevation_rad)
    : towards_x_(std::cos(sun_azimuth_rad)),
      towards_y_(std::sin(sun_azimuth_rad)),
      cotangent_(std::min(kLongest_cotangent, 1.0 / std::tan(sun_elevation_rad))),
      sine_(std::max(0.15, std::sin(sun_elevation_rad))) {
  double x_max_m = -1e9, y_max_m = -1e9;
  x_min_m_ = y_min_m_ = 1e9;
  for (const Cylinder& c : world.cylinders) {
    x_min_m_ = std::min(x_min_m_, c.x_m - kBeside_m);
    y_min_m_ = std::min(y_min_m_, c.y_m - kBeside_m);
    x_max_m = std::max(x_max_m, c.x_m + kBeside_m);
    y_max_m = std::max(y_max_m, c.y_m + kBeside_m);
  }
  constexpr double kMax_m = 400.0;
  if (x_max_m < x_min_m_ || x_max_m - x_min_m_ > kMax_m || y_max_m - y_min_m_ > kMax_m) return;
  num_x_ = static_cast<int>((x_max_m - x_min_m_) / kCell_m) + 1;
  num_y_ = static_cast<int>((y_max_m - y_min_m_) / kCell_m) + 1;
  cells_.resize(static_cast<std::size_t>(num_x_) * num_y_);
  for (const Cylinder& c : world.cylinders) add(c);
  for (const Box& b : world.boxes) add(b);
  for (const Crown& c : world.crowns) add(c);
}

ShadowMap::Cell* ShadowMap::at(double x_m, double y_m) {
  const int i = static_cast<int>(std::floor((x_m - x_min_m_) / kCell_m));
  const int j = static_cast<int>(std::floor((y_m - y_min_m_) / kCell_m));
  if (i < 0 || j < 0 || i >= num_x_ || j >= num_y_) return nullptr;
  return &cells_[static_cast<std::size_t>(j) * num_x_ + i];
}

void ShadowMap::add_line(double x_m, double y_m, double base_m, double top_m, int target) {
  const double step_m = 0.7 * kCell_m / std::max(0.1, cotangent_);
  for (double z_m = base_m; z_m <= top_m; z_m += step_m) {
    Cell* cell = at(x_m - towards_x_ * cotangent_ * z_m, y_m - towards_y_ * cotangent_ * z_m);
    if (cell == nullptr || z_m <= cell->top_m) continue;
    cell->top_m = static_cast<float>(z_m);
    cell->target = target;
  }
}

void ShadowMap::add(const Cylinder& cylinder) {
  if (cylinder.radius_m < kThinnest_m || cylinder.sway_m > 0.0) return;
  for (double across_m = -cylinder.radius_m; across_m <= cylinder.radius_m;
       across_m += std::min(0.7 * kCell_m, cylinder.radius_m)) {
    add_line(cylinder.x_m - towards_y_ * across_m, cylinder.y_m + towards_x_ * across_m,
             cylinder.base_m, cylinder.base_m + cylinder.height_m, cylinder.target);
  }
}

void ShadowMap::add(const Box& box) {
  const geometry::Pose2 T_map_box{box.x_m, box.y_m, box.yaw_rad};
  const double step_m = 0.7 * kCell_m;
  const auto line = [&](double along_m, double across_m) {
    const Eigen::Vector2d p = transform(T_map_box, {along_m, across_m});
    add_line(p.x(), p.y(), box.base_m, box.base_m + box.height_m, box.target);
  };
  for (double along_m = -0.5 * box.length_m; along_m <= 0.5 * box.length_m; along_m += step_m) {
    for (double across_m = -0.5 * box.width_m; across_m <= 0.5 * box.width_m; across_m += step_m) {
      line(along_m, across_m);
    }
  }
}

void ShadowMap::add(const Crown& crown) {
  // The shadow of a ball: an ellipse, longer away from the sun.
  const double middle_x_m = crown.x_m - towards_x_ * cotangent_ * crown.z_m;
  const double middle_y_m = crown.y_m - towards_y_ * cotangent_ * crown.z_m;
  const double long_m = crown.radius_m / sine_;
  const auto seed = crown.appearance.texture_seed;
  for (double along_m = -long_m; along_m <= long_m; along_m += 0.5 * kCell_m) {
    for (double across_m = -crown.radius_m; across_m <= crown.radius_m; across_m += 0.5 * kCell_m) {
      const double off = std::hypot(along_m / long_m, across_m / crown.radius_m);
      if (off > 1.0) continue;
      Cell* cell = at(middle_x_m + towards_x_ * along_m - towards_y_ * across_m,
                      middle_y_m + towards_y_ * along_m + towards_x_ * across_m);
      if (cell == nullptr) continue;
      // The same leaves as rendered: gaps between clumps, more of them towards the border.
      const auto a = static_cast<float>(along_m * sine_), b = static_cast<float>(across_m);
      const float leaves = 0.6f * value_noise(a * 9.0f, b * 9.0f, seed) +
                           0.4f * value_noise(a * 3.0f, b * 3.0f, seed + 1);
      const auto dense = static_cast<float>(crown.foliage * (1.3 - 0.9 * off * off));
      const float filled = std::clamp(2.5f * (leaves + 2.0f * dense - 1.0f) + 0.5f, 0.0f, 0.92f);
      cell->crown = std::min(cell->crown, 1.0f - filled);
    }
  }
}

float ShadowMap::open(float x_m, float y_m, float z_m, int target) const {
  if (cells_.empty()) return 1.0f;
  const double gx = (x_m - towards_x_ * cotangent_ * z_m - x_min_m_) / kCell_m - 0.5;
  const double gy = (y_m - towards_y_ * cotangent_ * z_m - y_min_m_) / kCell_m - 0.5;
  const int i = static_cast<int>(std::floor(gx)), j = static_cast<int>(std::floor(gy));
  if (i < 0 || j < 0 || i + 1 >= num_x_ || j + 1 >= num_y_) return 1.0f;
  const auto u = static_cast<float>(gx - i), v = static_cast<float>(gy - j);
  const auto value = [&](int di, int dj) {
    const Cell& cell = cells_[static_cast<std::size_t>(j + dj) * num_x_ + i + di];
    const bool solid = cell.top_m > z_m + 0.03f && cell.target != target;
    return solid ? 0.0f : cell.crown;
  };
  return (value(0, 0) * (1.0f - u) + value(1, 0) * u) * (1.0f - v) +
         (value(0, 1) * (1.0f - u) + value(1, 1) * u) * v;
}

}  // namespace orchard::simulation
