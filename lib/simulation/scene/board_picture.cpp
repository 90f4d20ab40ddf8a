// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/board_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "simulation/texture.hpp"

namespace orchard::simulation {
namespace {

constexpr double kBackOfBoard = 0.45;  ///< fraction of the light that bare wood reflects

/// Grey levels of the background: soft stains and hard edges.
float clutter_at(float x, float y, std::uint32_t seed, float contrast) {
  const float soft = value_noise(x * 3.0f, y * 3.0f, seed);
  const float fine = value_noise(x * 17.0f, y * 17.0f, seed + 1);
  const float hard = value_noise(x * 5.0f, y * 2.0f, seed + 2) > 0.15f ? 1.0f : -0.4f;
  return 105.0f + contrast * (0.6f * soft + 0.25f * fine + 0.6f * hard);
}

}  // namespace

BoardPainter::BoardPainter(const geometry::CameraIntrinsics& camera,
                           const calibration::BoardConfig& board, const BoardPictureConfig& config)
    : camera_(camera), pattern_(board), config_(config) {
  const geometry::CameraModel model(camera);
  const int n = config.samples_per_side;
  rays_.reserve(static_cast<std::size_t>(camera.width_px) * camera.height_px * n * n);
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      for (int i = 0; i < n * n; ++i) {
        const double du = (i % n + 0.5) / n - 0.5, dv = (i / n + 0.5) / n - 0.5;
        const Eigen::Vector2d ray = model.undistort({u + du, v + dv});
        rays_.push_back({static_cast<float>(ray.x()), static_cast<float>(ray.y())});
      }
    }
  }
}

calibration::GreyPicture BoardPainter::take(const std::optional<Eigen::Isometry3d>& T_camera_board,
                                            Random& random) const {
  const int width_px = camera_.width_px, height_px = camera_.height_px;
  const auto seed = static_cast<std::uint32_t>(random.bits());
  const double light_rad = random.uniform(0.0, 6.283185307179586);
  const double exposure = random.uniform(0.85, 1.1);
  const auto shade_x = static_cast<float>(config_.shading * std::cos(light_rad) / width_px);
  const auto shade_y = static_cast<float>(config_.shading * std::sin(light_rad) / height_px);

  // p_board = R^T (t ray - p): the ray meets the board's plane where the third component is 0.
  Eigen::Matrix3d R_board_camera = Eigen::Matrix3d::Identity();
  Eigen::Vector3d camera_board = Eigen::Vector3d::Zero();  // camera position in the board frame
  if (T_camera_board) {
    R_board_camera = T_camera_board->linear().transpose();
    camera_board = -(R_board_camera * T_camera_board->translation());
  }
  const bool front = camera_board.z() < 0.0;

  cv::Mat sharp(height_px, width_px, CV_32FC1);
  const int samples = config_.samples_per_side * config_.samples_per_side;
  const Ray* ray = rays_.data();
  for (int v = 0; v < height_px; ++v) {
    for (int u = 0; u < width_px; ++u) {
      double sum = 0.0, clutter = -1.0;  // for the background one sample per pixel is enough
      for (int i = 0; i < samples; ++i, ++ray) {
        double grey = -1.0;
        if (T_camera_board) {
          const Eigen::Vector3d d = R_board_camera * Eigen::Vector3d(ray->x, ray->y, 1.0);
          const double t = -camera_board.z() / d.z();
          if (t > 0.0 && std::isfinite(t)) {
            const auto white =
                pattern_.is_white(camera_board.x() + t * d.x(), camera_board.y() + t * d.y());
            if (white) {
              grey = !front ? kBackOfBoard * config_.white : *white ? config_.white : config_.black;
            }
          }
        }
        if (grey < 0.0) {
          if (clutter < 0.0) {
            clutter = std::max(
                0.0f, clutter_at(ray->x, ray->y, seed, static_cast<float>(config_.clutter)));
          }
          grey = clutter;
        }
        sum += grey;
      }
      const double light =
          exposure * (1.0 + shade_x * (u - 0.5 * width_px) + shade_y * (v - 0.5 * height_px));
      sharp.at<float>(v, u) = static_cast<float>(sum / samples * light);
    }
  }
  if (config_.blur_px > 0.0) {
    cv::GaussianBlur(sharp, sharp, cv::Size(7, 7), config_.blur_px, config_.blur_px,
                     cv::BORDER_REPLICATE);
  }
  calibration::GreyPicture picture{width_px, height_px, {}};
  picture.grey.reserve(sharp.total());
  for (int v = 0; v < height_px; ++v) {
    for (int u = 0; u < width_px; ++u) {
      const double level = sharp.at<float>(v, u) + random.normal(0.0, config_.noise_sd);
      picture.grey.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(level), 0l, 255l)));
    }
  }
  return picture;
}

}  // namespace orchard::simulation
