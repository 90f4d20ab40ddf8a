// SPDX-License-Identifier: BSD-3-Clause
// What CameraRenderer draws besides upright cylinders and the background: boxes and crowns.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/angles.hpp"
#include "simulation/sensor/camera_renderer.hpp"

namespace orchard::simulation {
namespace {

/// A point in base axes, relative to the camera's foot.
struct Place {
  float x_m;
  float y_m;
};

Place from_camera(const Pose2& T_map_camera, double x_m, double y_m) {
  const Eigen::Vector2f p = inverse_transform(T_map_camera, {x_m, y_m}).cast<float>();
  return {p.x(), p.y()};
}

/// Distances at which a level ray enters and leaves a rectangle, and the entry face.
struct Crossing {
  float enter_m = 0.0f;
  float leave_m = std::numeric_limits<float>::infinity();
  std::size_t axis = 0;
  float sign = 1.0f;  ///< of the face's normal along its axis
  bool hit = true;
};

Crossing cross(const std::array<float, 2>& from, const std::array<float, 2>& towards,
               const std::array<float, 2>& half) {
  Crossing crossing;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const float t =
        std::abs(towards[axis]) < 1e-6f ? std::copysign(1e-6f, towards[axis]) : towards[axis];
    const float one_m = (-half[axis] - from[axis]) / t, other_m = (half[axis] - from[axis]) / t;
    if (std::min(one_m, other_m) > crossing.enter_m) {
      crossing.enter_m = std::min(one_m, other_m);
      crossing.axis = axis;
      crossing.sign = t > 0.0f ? -1.0f : 1.0f;
    }
    crossing.leave_m = std::min(crossing.leave_m, std::max(one_m, other_m));
  }
  crossing.hit =
      crossing.enter_m > CameraRenderer::kNearest_m && crossing.enter_m < crossing.leave_m;
  return crossing;
}

}  // namespace

void CameraRenderer::draw_box(const Frame& frame, const Box& box) const {
  const Place middle = from_camera(frame.T_map_camera, box.x_m, box.y_m);
  const float distance_m = std::hypot(middle.x_m, middle.y_m);
  const auto reach_m = static_cast<float>(0.5 * std::hypot(box.length_m, box.width_m));
  if (distance_m > kFarthest_m || distance_m - reach_m < kNearest_m) return;
  const auto azimuth_rad =
      static_cast<float>(geometry::wrap_angle_rad(std::atan2(middle.y_m, middle.x_m) - axis_rad_));
  const float half_rad = std::asin(std::min(1.0f, reach_m / distance_m));
  const double yaw_rad = box.yaw_rad - frame.T_map_camera.yaw_rad;
  const auto c = static_cast<float>(std::cos(yaw_rad)), s = static_cast<float>(std::sin(yaw_rad));
  const std::array<float, 2> half{static_cast<float>(0.5 * box.length_m),
                                  static_cast<float>(0.5 * box.width_m)};
  const std::array<float, 2> from{-(c * middle.x_m + s * middle.y_m),
                                  -(-s * middle.x_m + c * middle.y_m)};
  const auto camera_m = static_cast<float>(camera_height_m_);
  const auto foot_m = static_cast<float>(box.base_m);
  const auto top_m = static_cast<float>(box.base_m + box.height_m);
  const auto ambient = static_cast<float>(frame.world.ambient);
  const Appearance& observation = box.appearance;
  const Bgr base = from_hsv(observation.hue_deg, observation.saturation, observation.value);

  for (int u = 0; u < width_px_; ++u) {
    if (columns_[u].azimuth_max_rad < azimuth_rad - half_rad ||
        columns_[u].azimuth_min_rad > azimuth_rad + half_rad) {
      continue;
    }
    for (int v = 0; v < height_px_; ++v) {
      const Ray& r = ray(u, v);
      const std::array<float, 2> towards{c * r.x + s * r.y, -s * r.x + c * r.y};
      const Crossing crossing = cross(from, towards, half);
      if (!crossing.hit) continue;
      float t_m = crossing.enter_m;
      float z_m = camera_m + t_m * r.slope;
      float facing = 0.0f, along_m = 0.0f, up_m = z_m - foot_m, fraction = 1.0f;
      const float pixel_m = t_m * r.slope_height;
      if (z_m > top_m) {
        // The ray passes over the near edge and meets the top.
        if (r.slope >= 0.0f) continue;
        t_m = (top_m - camera_m) / r.slope;
        if (t_m > crossing.leave_m) continue;
        z_m = top_m;
        facing = frame.sun_z;
        along_m = from[0] + t_m * towards[0];
        up_m = from[1] + t_m * towards[1];
      } else {
        fraction = std::clamp((z_m - foot_m) / pixel_m + 0.5f, 0.0f, 1.0f);
        if (fraction <= 0.0f) continue;
        const std::size_t other = 1 - crossing.axis;
        along_m = from[other] + t_m * towards[other];
        const float nx = crossing.axis == 0 ? c : -s, ny = crossing.axis == 0 ? s : c;
        facing = std::max(0.0f, crossing.sign * (nx * frame.sun_x + ny * frame.sun_y));
      }
      Bgr colour = surface_colour(observation, base, along_m, 1.0f, up_m, t_m * r.width_rad);
      if (frame.lighting == nullptr) {
        colour = colour * (ambient + (1.0f - ambient) * facing);
      } else {
        const float lit = facing > 0.0f ? open(frame, t_m * r.x, t_m * r.y, z_m, box.target) : 0.0f;
        colour = frame.lighting->shade(linear_of(colour), facing, lit, kUprightSky);
      }
      blend(frame.picture, static_cast<std::size_t>(v) * width_px_ + u, colour, fraction);
    }
  }
}

void CameraRenderer::draw_crown(const Frame& frame, const Crown& crown) const {
  constexpr float kFarthestCrown_m = 30.0f;
  const Place middle = from_camera(frame.T_map_camera, crown.x_m, crown.y_m);
  const float distance_m = std::hypot(middle.x_m, middle.y_m);
  const auto radius_m = static_cast<float>(crown.radius_m);
  if (distance_m > kFarthestCrown_m || distance_m < radius_m) return;
  const auto azimuth_rad =
      static_cast<float>(geometry::wrap_angle_rad(std::atan2(middle.y_m, middle.x_m) - axis_rad_));
  const float half_rad = std::asin(std::min(1.0f, radius_m / distance_m));
  const float right_x = middle.y_m / distance_m, right_y = -middle.x_m / distance_m;
  const float up_m = static_cast<float>(crown.z_m - camera_height_m_);
  const Appearance& observation = crown.appearance;
  Bgr base = from_hsv(observation.hue_deg, observation.saturation, observation.value);
  if (frame.lighting != nullptr) base = linear_of(base);
  const auto ambient = static_cast<float>(frame.world.ambient);

  for (int u = 0; u < width_px_; ++u) {
    if (columns_[u].azimuth_max_rad < azimuth_rad - half_rad ||
        columns_[u].azimuth_min_rad > azimuth_rad + half_rad) {
      continue;
    }
    for (int v = 0; v < height_px_; ++v) {
      const Ray& r = ray(u, v);
      const float along_m = middle.x_m * r.x + middle.y_m * r.y;
      if (along_m <= 0.0f) continue;
      const float across = (middle.x_m * r.y - middle.y_m * r.x) / radius_m;  // to the left
      const float above = (along_m * r.slope - up_m) / radius_m;
      const float off2 = across * across + above * above;
      if (off2 >= 1.0f) continue;
      const float a_m = across * radius_m, b_m = above * radius_m;
      const float leaves = 0.6f * value_noise(a_m * 18.0f, b_m * 18.0f, observation.texture_seed) +
                           0.4f * value_noise(a_m * 5.0f, b_m * 5.0f, observation.texture_seed + 1);
      const float dense = static_cast<float>(crown.foliage) * (1.3f - 0.9f * off2);
      const float fraction = std::clamp(2.5f * (leaves + 2.0f * dense - 1.0f) + 0.5f, 0.0f, 1.0f);
      if (fraction <= 0.0f) continue;
      const float front = std::sqrt(1.0f - off2);
      const float nx = -front * r.x - across * right_x, ny = -front * r.y - across * right_y;
      const float facing =
          std::max(0.0f, nx * frame.sun_x + ny * frame.sun_y + above * frame.sun_z);
      const float gaps = std::clamp(0.55f + 0.45f * leaves, 0.0f, 1.0f);
      const Bgr colour = frame.lighting == nullptr
                             ? base * (gaps * (ambient + (1.0f - ambient) * facing))
                             : frame.lighting->shade(base, 0.3f + 0.7f * facing, gaps,
                                                     gaps * (0.6f + 0.3f * above));
      blend(frame.picture, static_cast<std::size_t>(v) * width_px_ + u, colour, fraction);
    }
  }
}

}  // namespace orchard::simulation
