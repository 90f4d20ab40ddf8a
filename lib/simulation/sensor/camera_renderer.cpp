// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/camera_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>

#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "simulation/texture.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::simulation {
namespace {

constexpr float kThin_m = 0.007f;  ///< stalks and twigs are invisible beyond a few metres
constexpr float kFarthestThin_m = 6.0f;

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

CameraRenderer::CameraRenderer(const RigConfig& rig)
    : rig_(rig),
      width_px_(rig.camera.intrinsics.width_px),
      height_px_(rig.camera.intrinsics.height_px) {
  const geometry::CameraModel camera(rig.camera.intrinsics);
  const geometry::LaserToCamera to_camera(rig.camera.extrinsics);
  const Eigen::Matrix3d R_laser_camera = to_camera.rotation().transpose();
  const Eigen::Vector3d centre_laser = -(R_laser_camera * to_camera.translation_m());
  const Pose2 T_base_camera =
      compose(Pose2{rig.laser.mount_x_m, rig.laser.mount_y_m, rig.laser.mount_yaw_rad},
              {centre_laser.x(), centre_laser.y(), 0.0});
  camera_x_m_ = T_base_camera.x_m;
  camera_y_m_ = T_base_camera.y_m;
  camera_height_m_ = rig.simulation.scanner.height_m + centre_laser.z();

  const auto direction = [&](double u, double v) {
    const Eigen::Vector2d n = camera.undistort({u, v});
    const Eigen::Vector3d d = R_laser_camera * Eigen::Vector3d(n.x(), n.y(), 1.0);
    const Eigen::Vector2d level = geometry::rotation(rig.laser.mount_yaw_rad) * d.head<2>();
    return Eigen::Vector3d(level.x(), level.y(), d.z());
  };
  const auto azimuth = [](const Eigen::Vector3d& d) { return std::atan2(d.y(), d.x()); };
  const auto slope = [](const Eigen::Vector3d& d) { return d.z() / std::hypot(d.x(), d.y()); };
  axis_rad_ = azimuth(direction(0.5 * (width_px_ - 1), 0.5 * (height_px_ - 1)));

  rays_.resize(static_cast<std::size_t>(width_px_) * height_px_);
  columns_.assign(static_cast<std::size_t>(width_px_), {10.0f, -10.0f});
  for (int v = 0; v < height_px_; ++v) {
    for (int u = 0; u < width_px_; ++u) {
      const Eigen::Vector3d d = direction(u, v);
      const Eigen::Vector3d left = direction(u - 0.5, v), right = direction(u + 0.5, v);
      const Eigen::Vector3d above = direction(u, v - 0.5), below = direction(u, v + 0.5);
      Ray& ray = rays_[static_cast<std::size_t>(v) * width_px_ + u];
      const double az = azimuth(d);
      ray.x = static_cast<float>(std::cos(az));
      ray.y = static_cast<float>(std::sin(az));
      ray.slope = static_cast<float>(slope(d));
      ray.width_rad =
          static_cast<float>(std::abs(geometry::wrap_angle_rad(azimuth(right) - azimuth(left))));
      ray.slope_height = static_cast<float>(std::abs(slope(above) - slope(below)));
      const auto relative = static_cast<float>(geometry::wrap_angle_rad(az - axis_rad_));
      columns_[u].azimuth_min_rad = std::min(columns_[u].azimuth_min_rad, relative - ray.width_rad);
      columns_[u].azimuth_max_rad = std::max(columns_[u].azimuth_max_rad, relative + ray.width_rad);
    }
  }
}

void CameraRenderer::cast_shadows(const World& world) {
  const LightConfig& light = rig_.simulation.light;
  if (!light.enabled || !light.shadows) return;
  shadows_ = ShadowMap(world, sun_azimuth_rad(world), sun_elevation_rad(world));
}

double CameraRenderer::sun_azimuth_rad(const World& world) const {
  const LightConfig& light = rig_.simulation.light;
  return !light.enabled || light.sun_from_seed ? world.light_azimuth_rad
                                               : light.sun_azimuth_deg * geometry::kPi / 180.0;
}

double CameraRenderer::sun_elevation_rad(const World& world) const {
  const LightConfig& light = rig_.simulation.light;
  return !light.enabled || light.sun_from_seed ? world.light_elevation_rad
                                               : light.sun_elevation_deg * geometry::kPi / 180.0;
}

/// Fraction of the sun that reaches a point, given in base axes relative to the camera's foot.
float CameraRenderer::open(const Frame& frame, float x_m, float y_m, float z_m, int target) const {
  if (shadows_.empty()) return 1.0f;
  const Pose2& T = frame.T_map_camera;
  const auto c = static_cast<float>(std::cos(T.yaw_rad));
  const auto s = static_cast<float>(std::sin(T.yaw_rad));
  return shadows_.open(static_cast<float>(T.x_m) + c * x_m - s * y_m,
                       static_cast<float>(T.y_m) + s * x_m + c * y_m, z_m, target);
}

void CameraRenderer::blend(Picture& picture, std::size_t pixel, const Bgr& colour, float fraction) {
  float* p = &picture.bgr[3 * pixel];
  const Bgr blended = mix({p[0], p[1], p[2]}, colour, fraction);
  p[0] = blended.b;
  p[1] = blended.g;
  p[2] = blended.r;
}

CameraRenderer::Bearing CameraRenderer::bearing_of(const Pose2& T_map_camera, double x_m,
                                                   double y_m) const {
  const Eigen::Vector2f p = inverse_transform(T_map_camera, {x_m, y_m}).cast<float>();
  return {p.x(), p.y(), std::hypot(p.x(), p.y()),
          static_cast<float>(geometry::wrap_angle_rad(std::atan2(p.y(), p.x()) - axis_rad_))};
}

template <class Function>
void CameraRenderer::for_each_ray(float azimuth_rad, float half_rad, Function function) const {
  for (int u = 0; u < width_px_; ++u) {
    if (columns_[u].azimuth_max_rad < azimuth_rad - half_rad ||
        columns_[u].azimuth_min_rad > azimuth_rad + half_rad) {
      continue;
    }
    for (int v = 0; v < height_px_; ++v) {
      const std::size_t pixel = static_cast<std::size_t>(v) * width_px_ + u;
      function(rays_[pixel], pixel);
    }
  }
}

Bgr CameraRenderer::lit(const Frame& frame, const Bgr& colour, float facing,
                        const Eigen::Vector3f& p, int target) const {
  if (frame.lighting == nullptr) {
    const auto ambient = static_cast<float>(frame.world.ambient);
    return colour * (ambient + (1.0f - ambient) * facing);
  }
  const float sun = facing > 0.0f ? open(frame, p.x(), p.y(), p.z(), target) : 0.0f;
  return frame.lighting->shade(linear_of(colour), facing, sun, kUprightSky);
}

void CameraRenderer::draw_background(const Frame& frame) const {
  const World& world = frame.world;
  const Pose2& T_map_camera = frame.T_map_camera;
  const auto c = static_cast<float>(std::cos(T_map_camera.yaw_rad));
  const auto s = static_cast<float>(std::sin(T_map_camera.yaw_rad));
  const auto height_m = static_cast<float>(camera_height_m_);
  const float horizon = horizon_slope(world, height_m);
  float* pixel = frame.picture.bgr.data();
  for (const Ray& ray : rays_) {
    const float dx = c * ray.x - s * ray.y, dy = s * ray.x + c * ray.y;
    const float ground_fraction =
        std::clamp((horizon - ray.slope) / ray.slope_height + 0.5f, 0.0f, 1.0f);
    Bgr colour;
    if (ground_fraction < 1.0f) {
      colour = backdrop_colour(world, std::atan2(dy, dx), ray.slope);
      if (frame.lighting != nullptr) colour = frame.lighting->emit(linear_of(colour));
    }
    if (ground_fraction > 0.0f) {
      const float distance_m = height_m / -std::min(ray.slope, horizon);
      const float footprint_m =
          distance_m * std::max(ray.width_rad, ray.slope_height * distance_m / height_m * 0.3f);
      const float x_m = static_cast<float>(T_map_camera.x_m) + distance_m * dx;
      const float y_m = static_cast<float>(T_map_camera.y_m) + distance_m * dy;
      Bgr ground = ground_colour(world, x_m, y_m, footprint_m);
      if (frame.lighting != nullptr) {
        const float sun = shadows_.open(x_m, y_m, 0.0f, -2);
        ground = frame.lighting->shade(linear_of(ground), frame.sun_z, sun, 1.0f);
      }
      colour = mix(colour, ground, ground_fraction);
    }
    *pixel++ = colour.b;
    *pixel++ = colour.g;
    *pixel++ = colour.r;
  }
}

void CameraRenderer::draw_cylinder(const Frame& frame, const Cylinder& cylinder) const {
  const Pose2& T_map_camera = frame.T_map_camera;
  const double c = std::cos(T_map_camera.yaw_rad), s = std::sin(T_map_camera.yaw_rad);
  const Bearing foot = bearing_of(T_map_camera, cylinder.x_m, cylinder.y_m);
  const auto radius_m = static_cast<float>(cylinder.radius_m);
  const float distance_m = foot.distance_m;
  if (distance_m - radius_m < kNearest_m || distance_m > kFarthest_m) return;
  if (radius_m < kThin_m && distance_m > kFarthestThin_m) return;

  const auto camera_height_m = static_cast<float>(camera_height_m_);
  const auto foot_m = static_cast<float>(cylinder.base_m);
  const auto top_m = static_cast<float>(cylinder.base_m + cylinder.height_m);
  const bool leans = cylinder.lean_x != 0.0 || cylinder.lean_y != 0.0;
  const auto lean_x = static_cast<float>(c * cylinder.lean_x + s * cylinder.lean_y);
  const auto lean_y = static_cast<float>(-s * cylinder.lean_x + c * cylinder.lean_y);
  const auto level_m = static_cast<float>(rig_.simulation.scanner.height_m);
  const float beside_rad =
      leans ? std::hypot(lean_x, lean_y) * cylinder.height_m / distance_m : 0.0f;
  const float half_rad = std::asin(std::min(1.0f, radius_m / distance_m)) + beside_rad;
  const Appearance& observation = cylinder.appearance;
  const Bgr base = from_hsv(observation.hue_deg, observation.saturation, observation.value);

  for_each_ray(foot.azimuth_rad, half_rad, [&](const Ray& r, std::size_t pixel) {
    float x_m = foot.x_m, y_m = foot.y_m;
    if (leans) {
      const float off_m = camera_height_m + distance_m * r.slope - level_m;
      x_m += lean_x * off_m;
      y_m += lean_y * off_m;
    }
    const float along_m = x_m * r.x + y_m * r.y;
    if (along_m <= 0.0f) return;
    const float across_m = x_m * r.y - y_m * r.x;  // of the axis, to the ray's right
    const float beside = (radius_m - std::abs(across_m)) / (along_m * r.width_rad) + 0.5f;
    if (beside <= 0.0f) return;
    const float inside_m = std::sqrt(std::max(0.0f, radius_m * radius_m - across_m * across_m));
    const float t_m = along_m - inside_m;
    const float z_m = camera_height_m + t_m * r.slope;
    const float pixel_m = t_m * r.slope_height;
    const float fraction = std::min(1.0f, beside) *
                           std::clamp((top_m - z_m) / pixel_m + 0.5f, 0.0f, 1.0f) *
                           std::clamp((z_m - foot_m) / pixel_m + 0.5f, 0.0f, 1.0f);
    if (fraction <= 0.0f) return;
    // The normal at the point where the ray enters.
    const float nx = (t_m * r.x - x_m) / radius_m, ny = (t_m * r.y - y_m) / radius_m;
    const float lambert = std::max(0.0f, nx * frame.sun_x + ny * frame.sun_y);
    const float angle_rad = std::atan2(ny, nx) + static_cast<float>(T_map_camera.yaw_rad);
    const Bgr colour =
        surface_colour(observation, base, angle_rad, radius_m, z_m - foot_m, t_m * r.width_rad);
    blend(frame.picture, pixel,
          lit(frame, colour, lambert, {t_m * r.x, t_m * r.y, z_m}, cylinder.target), fraction);
  });
}

Picture CameraRenderer::draw(const World& world, const Pose2& T_map_base,
                             const Exposure& exposure) const {
  const Pose2 T_map_camera = compose(T_map_base, {camera_x_m_, camera_y_m_, 0.0});
  Picture picture{width_px_, height_px_, {}};
  picture.bgr.resize(rays_.size() * 3);
  std::optional<Lighting> lighting;
  const SimulationConfig& config = rig_.simulation;
  if (config.light.enabled) {
    lighting.emplace(config.light, config.camera_response, exposure.time_s);
  }
  const double sun_rad = sun_azimuth_rad(world) - T_map_camera.yaw_rad;
  const double elevation_rad = sun_elevation_rad(world);
  const Frame frame{world,
                    T_map_camera,
                    lighting ? &*lighting : nullptr,
                    static_cast<float>(std::cos(sun_rad) * std::cos(elevation_rad)),
                    static_cast<float>(std::sin(sun_rad) * std::cos(elevation_rad)),
                    static_cast<float>(std::sin(elevation_rad)),
                    picture};
  draw_background(frame);

  enum Kind { kCylinder, kBox, kCrown };
  std::vector<std::tuple<double, Kind, std::size_t>> far_to_near;
  const auto add_all = [&](const auto& shapes, Kind kind) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      far_to_near.emplace_back(
          -std::hypot(shapes[i].x_m - T_map_camera.x_m, shapes[i].y_m - T_map_camera.y_m), kind, i);
    }
  };
  add_all(world.cylinders, kCylinder);
  add_all(world.boxes, kBox);
  add_all(world.crowns, kCrown);
  std::sort(far_to_near.begin(), far_to_near.end());
  for (const auto& [distance_m, kind, index] : far_to_near) {
    if (kind == kCylinder) draw_cylinder(frame, world.cylinders[index]);
    if (kind == kBox) draw_box(frame, world.boxes[index]);
    if (kind == kCrown) draw_crown(frame, world.crowns[index]);
  }
  return picture;
}

/// Converts linear light to stored values: smear, vignetting, exposure, clipping, gamma.
void CameraRenderer::respond(const Lighting& lighting, const Exposure& exposure,
                             Picture& picture) const {
  const double smear_px = std::abs(exposure.yaw_rate_radps) *
                          rig_.simulation.camera_response.exposure_s *
                          rig_.camera.intrinsics.fc_px[0];
  if (smear_px > 0.05) {
    // The pixel and its neighbours within the smear of the turn.
    const int half = static_cast<int>(std::ceil(0.5 * smear_px));
    cv::Mat kernel(1, 2 * half + 1, CV_32F);
    for (int i = -half; i <= half; ++i) {
      const double from = std::max(i - 0.5, -0.5 * smear_px - 0.5);
      const double to = std::min(i + 0.5, 0.5 * smear_px + 0.5);
      kernel.at<float>(0, i + half) = static_cast<float>(std::max(0.0, to - from));
    }
    kernel /= cv::sum(kernel)[0];
    cv::Mat pixels(height_px_, width_px_, CV_32FC3, picture.bgr.data());
    cv::Mat smeared;
    cv::filter2D(pixels, smeared, -1, kernel, cv::Point(-1, -1), 0, cv::BORDER_REPLICATE);
    smeared.copyTo(pixels);
  }
  const float middle_u = 0.5f * static_cast<float>(width_px_ - 1);
  const float middle_v = 0.5f * static_cast<float>(height_px_ - 1);
  const float scale = 1.0f / (middle_u * middle_u + middle_v * middle_v);
  float* p = picture.bgr.data();
  for (int v = 0; v < height_px_; ++v) {
    for (int u = 0; u < width_px_; ++u, p += 3) {
      const float du = static_cast<float>(u) - middle_u, dv = static_cast<float>(v) - middle_v;
      const Bgr stored = lighting.store({p[0], p[1], p[2]}, (du * du + dv * dv) * scale);
      p[0] = stored.b;
      p[1] = stored.g;
      p[2] = stored.r;
    }
  }
}

vision::Image CameraRenderer::take(const World& world, const Pose2& T_map_base, Random& random,
                                   const Exposure& exposure) const {
  Picture picture = draw(world, T_map_base, exposure);
  const ImageConfig& config = rig_.simulation.image;
  const SimulationConfig& simulation = rig_.simulation;
  if (simulation.light.enabled) {
    respond(Lighting(simulation.light, simulation.camera_response, exposure.time_s), exposure,
            picture);
  }
  cv::Mat sharp(height_px_, width_px_, CV_32FC3, picture.bgr.data());
  cv::Mat blurred = sharp;
  if (config.blur_px > 0.0) {
    cv::GaussianBlur(sharp, blurred, cv::Size(5, 5), config.blur_px, config.blur_px,
                     cv::BORDER_REPLICATE);
  }
  if (config.noise_sd > 0.0) {
    // Each row takes its noise from a random position of one table: one draw per row, not per
    // pixel.
    constexpr std::size_t kTable = 8191;
    std::vector<float> table(kTable);
    for (float& value : table) value = static_cast<float>(random.normal(0.0, config.noise_sd));
    for (int v = 0; v < height_px_; ++v) {
      std::size_t k = random.bits() % kTable;
      float* row = blurred.ptr<float>(v);
      for (int i = 0; i < 3 * width_px_; ++i) {
        row[i] += table[k];
        if (++k == kTable) k = 0;
      }
    }
  }
  cv::Mat bytes;
  blurred.convertTo(bytes, CV_8UC3);
  vision::Image image;
  image.width_px = width_px_;
  image.height_px = height_px_;
  image.encoding = vision::Encoding::kJpeg;
  vision::PixelBlock pixels;
  pixels.area = {0, 0, width_px_, height_px_};
  pixels.bgr.assign(bytes.datastart, bytes.dataend);
  image.data = vision::write_jpeg(pixels, config.jpeg_quality, vision::JpegTransform::kExact);
  return image;
}

void CameraRenderer::draw_box(const Frame& frame, const Box& box) const {
  const Bearing middle = bearing_of(frame.T_map_camera, box.x_m, box.y_m);
  const auto reach_m = static_cast<float>(0.5 * std::hypot(box.length_m, box.width_m));
  if (middle.distance_m > kFarthest_m || middle.distance_m - reach_m < kNearest_m) return;
  const float half_rad = std::asin(std::min(1.0f, reach_m / middle.distance_m));
  const double yaw_rad = box.yaw_rad - frame.T_map_camera.yaw_rad;
  const auto c = static_cast<float>(std::cos(yaw_rad)), s = static_cast<float>(std::sin(yaw_rad));
  const std::array<float, 2> half{static_cast<float>(0.5 * box.length_m),
                                  static_cast<float>(0.5 * box.width_m)};
  const std::array<float, 2> from{-(c * middle.x_m + s * middle.y_m),
                                  -(-s * middle.x_m + c * middle.y_m)};
  const auto camera_m = static_cast<float>(camera_height_m_);
  const auto foot_m = static_cast<float>(box.base_m);
  const auto top_m = static_cast<float>(box.base_m + box.height_m);
  const Appearance& observation = box.appearance;
  const Bgr base = from_hsv(observation.hue_deg, observation.saturation, observation.value);

  for_each_ray(middle.azimuth_rad, half_rad, [&](const Ray& r, std::size_t pixel) {
    const std::array<float, 2> towards{c * r.x + s * r.y, -s * r.x + c * r.y};
    const Crossing crossing = cross(from, towards, half);
    if (!crossing.hit) return;
    float t_m = crossing.enter_m;
    float z_m = camera_m + t_m * r.slope;
    float facing = 0.0f, along_m = 0.0f, up_m = z_m - foot_m, fraction = 1.0f;
    const float pixel_m = t_m * r.slope_height;
    if (z_m > top_m) {
      // The ray passes over the near edge and meets the top.
      if (r.slope >= 0.0f) return;
      t_m = (top_m - camera_m) / r.slope;
      if (t_m > crossing.leave_m) return;
      z_m = top_m;
      facing = frame.sun_z;
      along_m = from[0] + t_m * towards[0];
      up_m = from[1] + t_m * towards[1];
    } else {
      fraction = std::clamp((z_m - foot_m) / pixel_m + 0.5f, 0.0f, 1.0f);
      if (fraction <= 0.0f) return;
      const std::size_t other = 1 - crossing.axis;
      along_m = from[other] + t_m * towards[other];
      const float nx = crossing.axis == 0 ? c : -s, ny = crossing.axis == 0 ? s : c;
      facing = std::max(0.0f, crossing.sign * (nx * frame.sun_x + ny * frame.sun_y));
    }
    const Bgr colour = surface_colour(observation, base, along_m, 1.0f, up_m, t_m * r.width_rad);
    blend(frame.picture, pixel, lit(frame, colour, facing, {t_m * r.x, t_m * r.y, z_m}, box.target),
          fraction);
  });
}

void CameraRenderer::draw_crown(const Frame& frame, const Crown& crown) const {
  constexpr float kFarthestCrown_m = 30.0f;
  const Bearing middle = bearing_of(frame.T_map_camera, crown.x_m, crown.y_m);
  const float distance_m = middle.distance_m;
  const auto radius_m = static_cast<float>(crown.radius_m);
  if (distance_m > kFarthestCrown_m || distance_m < radius_m) return;
  const float half_rad = std::asin(std::min(1.0f, radius_m / distance_m));
  const float right_x = middle.y_m / distance_m, right_y = -middle.x_m / distance_m;
  const float up_m = static_cast<float>(crown.z_m - camera_height_m_);
  const Appearance& observation = crown.appearance;
  Bgr base = from_hsv(observation.hue_deg, observation.saturation, observation.value);
  if (frame.lighting != nullptr) base = linear_of(base);
  const auto ambient = static_cast<float>(frame.world.ambient);

  for_each_ray(middle.azimuth_rad, half_rad, [&](const Ray& r, std::size_t pixel) {
    const float along_m = middle.x_m * r.x + middle.y_m * r.y;
    if (along_m <= 0.0f) return;
    const float across = (middle.x_m * r.y - middle.y_m * r.x) / radius_m;  // to the left
    const float above = (along_m * r.slope - up_m) / radius_m;
    const float off2 = across * across + above * above;
    if (off2 >= 1.0f) return;
    const float a_m = across * radius_m, b_m = above * radius_m;
    const float leaves = 0.6f * value_noise(a_m * 18.0f, b_m * 18.0f, observation.texture_seed) +
                         0.4f * value_noise(a_m * 5.0f, b_m * 5.0f, observation.texture_seed + 1);
    const float dense = static_cast<float>(crown.foliage) * (1.3f - 0.9f * off2);
    const float fraction = std::clamp(2.5f * (leaves + 2.0f * dense - 1.0f) + 0.5f, 0.0f, 1.0f);
    if (fraction <= 0.0f) return;
    const float front = std::sqrt(1.0f - off2);
    const float nx = -front * r.x - across * right_x, ny = -front * r.y - across * right_y;
    const float facing = std::max(0.0f, nx * frame.sun_x + ny * frame.sun_y + above * frame.sun_z);
    const float gaps = std::clamp(0.55f + 0.45f * leaves, 0.0f, 1.0f);
    const Bgr colour =
        frame.lighting == nullptr
            ? base * (gaps * (ambient + (1.0f - ambient) * facing))
            : frame.lighting->shade(base, 0.3f + 0.7f * facing, gaps, gaps * (0.6f + 0.3f * above));
    blend(frame.picture, pixel, colour, fraction);
  });
}

}  // namespace orchard::simulation
