// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/camera_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "geometry/laser_camera.hpp"
#include "simulation/texture.hpp"

namespace orchard::simulation {
namespace {

constexpr float kNearest_m = 0.05f;
constexpr float kFarthest_m = 40.0f;  ///< trunks farther away are less than a pixel or two

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
      compose({rig.laser.mount_x_m, rig.laser.mount_y_m, rig.laser.mount_yaw_rad},
              {centre_laser.x(), centre_laser.y(), 0.0});
  camera_x_m_ = T_base_camera.x_m;
  camera_y_m_ = T_base_camera.y_m;
  camera_height_m_ = rig.simulation.scanner.height_m + centre_laser.z();

  const auto direction = [&](double u, double v) {
    const Eigen::Vector2d n = camera.undistort({u, v});
    const Eigen::Vector3d d = R_laser_camera * Eigen::Vector3d(n.x(), n.y(), 1.0);
    const double yaw = rig.laser.mount_yaw_rad;
    return Eigen::Vector3d(std::cos(yaw) * d.x() - std::sin(yaw) * d.y(),
                           std::sin(yaw) * d.x() + std::cos(yaw) * d.y(), d.z());
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

void CameraRenderer::draw_background(const World& world, const Pose2& T_map_camera,
                                     Picture& picture) const {
  const auto c = static_cast<float>(std::cos(T_map_camera.yaw_rad));
  const auto s = static_cast<float>(std::sin(T_map_camera.yaw_rad));
  const auto height_m = static_cast<float>(camera_height_m_);
  const float horizon = horizon_slope(world, height_m);
  float* pixel = picture.bgr.data();
  for (const Ray& ray : rays_) {
    const float dx = c * ray.x - s * ray.y, dy = s * ray.x + c * ray.y;
    const float ground_share =
        std::clamp((horizon - ray.slope) / ray.slope_height + 0.5f, 0.0f, 1.0f);
    Bgr colour;
    if (ground_share < 1.0f) colour = backdrop_colour(world, std::atan2(dy, dx), ray.slope);
    if (ground_share > 0.0f) {
      const float distance_m = height_m / -std::min(ray.slope, horizon);
      const float footprint_m =
          distance_m * std::max(ray.width_rad, ray.slope_height * distance_m / height_m * 0.3f);
      const Bgr ground =
          ground_colour(world, static_cast<float>(T_map_camera.x_m) + distance_m * dx,
                        static_cast<float>(T_map_camera.y_m) + distance_m * dy, footprint_m);
      colour = mix(colour, ground, ground_share);
    }
    *pixel++ = colour.b;
    *pixel++ = colour.g;
    *pixel++ = colour.r;
  }
}

void CameraRenderer::draw_cylinder(const World& world, const Cylinder& cylinder,
                                   const Pose2& T_map_camera, Picture& picture) const {
  // into base axes, from the camera's foot
  const double c = std::cos(T_map_camera.yaw_rad), s = std::sin(T_map_camera.yaw_rad);
  const double ex = cylinder.x_m - T_map_camera.x_m, ey = cylinder.y_m - T_map_camera.y_m;
  const auto x_m = static_cast<float>(c * ex + s * ey);
  const auto y_m = static_cast<float>(-s * ex + c * ey);
  const auto radius_m = static_cast<float>(cylinder.radius_m);
  const float distance_m = std::hypot(x_m, y_m);
  if (distance_m - radius_m < kNearest_m || distance_m > kFarthest_m) return;
  const auto azimuth_rad =
      static_cast<float>(geometry::wrap_angle_rad(std::atan2(y_m, x_m) - axis_rad_));
  const float half_rad = std::asin(std::min(1.0f, radius_m / distance_m));

  const auto camera_height_m = static_cast<float>(camera_height_m_);
  const auto foot_m = static_cast<float>(cylinder.base_m);
  const auto top_m = static_cast<float>(cylinder.base_m + cylinder.height_m);
  const auto ambient = static_cast<float>(world.ambient);
  const double light_rad = world.light_azimuth_rad - T_map_camera.yaw_rad;
  const auto light_x =
      static_cast<float>(std::cos(light_rad) * std::cos(world.light_elevation_rad));
  const auto light_y =
      static_cast<float>(std::sin(light_rad) * std::cos(world.light_elevation_rad));
  const Appearance& look = cylinder.appearance;
  const Bgr base = from_hsv(look.hue_deg, look.saturation, look.value);

  for (int u = 0; u < width_px_; ++u) {
    if (columns_[u].azimuth_max_rad < azimuth_rad - half_rad ||
        columns_[u].azimuth_min_rad > azimuth_rad + half_rad) {
      continue;
    }
    for (int v = 0; v < height_px_; ++v) {
      const Ray& r = ray(u, v);
      const float along_m = x_m * r.x + y_m * r.y;
      if (along_m <= 0.0f) continue;
      const float across_m = x_m * r.y - y_m * r.x;  // of the axis, to the ray's right
      const float beside = (radius_m - std::abs(across_m)) / (along_m * r.width_rad) + 0.5f;
      if (beside <= 0.0f) continue;
      const float inside_m = std::sqrt(std::max(0.0f, radius_m * radius_m - across_m * across_m));
      const float t_m = along_m - inside_m;
      const float z_m = camera_height_m + t_m * r.slope;
      const float pixel_m = t_m * r.slope_height;
      const float share = std::min(1.0f, beside) *
                          std::clamp((top_m - z_m) / pixel_m + 0.5f, 0.0f, 1.0f) *
                          std::clamp((z_m - foot_m) / pixel_m + 0.5f, 0.0f, 1.0f);
      if (share <= 0.0f) continue;
      // the normal where the ray enters
      const float nx = (t_m * r.x - x_m) / radius_m, ny = (t_m * r.y - y_m) / radius_m;
      const float lambert = std::max(0.0f, nx * light_x + ny * light_y);
      const float angle_rad = std::atan2(ny, nx) + static_cast<float>(T_map_camera.yaw_rad);
      Bgr colour = surface_colour(look, base, angle_rad, radius_m, z_m - foot_m, t_m * r.width_rad);
      colour = colour * (ambient + (1.0f - ambient) * lambert);
      float* pixel = &picture.bgr[3 * (static_cast<std::size_t>(v) * width_px_ + u)];
      const Bgr blended = mix({pixel[0], pixel[1], pixel[2]}, colour, share);
      pixel[0] = blended.b;
      pixel[1] = blended.g;
      pixel[2] = blended.r;
    }
  }
}

Picture CameraRenderer::draw(const World& world, const Pose2& T_map_base) const {
  const Pose2 T_map_camera = compose(T_map_base, {camera_x_m_, camera_y_m_, 0.0});
  Picture picture{width_px_, height_px_, {}};
  picture.bgr.resize(rays_.size() * 3);
  draw_background(world, T_map_camera, picture);

  std::vector<std::pair<double, std::size_t>> far_to_near;
  for (std::size_t i = 0; i < world.cylinders.size(); ++i) {
    const Cylinder& cylinder = world.cylinders[i];
    far_to_near.emplace_back(
        -std::hypot(cylinder.x_m - T_map_camera.x_m, cylinder.y_m - T_map_camera.y_m), i);
  }
  std::sort(far_to_near.begin(), far_to_near.end());
  for (const auto& entry : far_to_near) {
    draw_cylinder(world, world.cylinders[entry.second], T_map_camera, picture);
  }
  return picture;
}

vision::Image CameraRenderer::take(const World& world, const Pose2& T_map_base,
                                   Random& random) const {
  Picture picture = draw(world, T_map_base);
  const ImageConfig& config = rig_.simulation.image;
  cv::Mat sharp(height_px_, width_px_, CV_32FC3, picture.bgr.data());
  cv::Mat blurred = sharp;
  if (config.blur_px > 0.0) {
    cv::GaussianBlur(sharp, blurred, cv::Size(5, 5), config.blur_px, config.blur_px,
                     cv::BORDER_REPLICATE);
  }
  if (config.noise_sd > 0.0) {
    // rows take their noise from random places of one table: a draw per row, not per pixel
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
  cv::imencode(".jpg", bytes, image.data, {cv::IMWRITE_JPEG_QUALITY, config.jpeg_quality});
  return image;
}

}  // namespace orchard::simulation
