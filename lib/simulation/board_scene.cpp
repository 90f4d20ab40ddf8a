// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/board_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "geometry/camera_model.hpp"
#include "simulation/sensor/laser_model.hpp"
#include "simulation/simulator.hpp"
#include "simulation/texture.hpp"
#include "vision/pixel_block.hpp"

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

Eigen::Isometry3d isometry(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = t;
  return T;
}

enum Target { kBoard, kLeftLeg, kRightLeg, kRoom, kNumTargets };

/// A thin upright wall between two points of the scan plane.
Box wall(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, Target target) {
  const Eigen::Vector2d along_m = to_m - from_m;
  Box box;
  box.x_m = 0.5 * (from_m.x() + to_m.x());
  box.y_m = 0.5 * (from_m.y() + to_m.y());
  box.yaw_rad = std::atan2(along_m.y(), along_m.x());
  box.length_m = along_m.norm();
  box.width_m = 1e-6;
  box.height_m = 10.0;
  box.target = target;
  return box;
}

/// The walls of a room and a cupboard in it, laser frame.
World room() {
  World world;
  world.num_targets = kNumTargets;
  const std::vector<Eigen::Vector2d> walls{{3.1, -2.6}, {3.3, 2.7}, {-2.0, 2.9}, {-2.1, -2.5}};
  for (std::size_t i = 0; i < walls.size(); ++i) {
    world.boxes.push_back(wall(walls[i], walls[(i + 1) % walls.size()], kRoom));
  }
  world.boxes.push_back(wall({2.2, 1.4}, {2.35, 2.0}, kRoom));
  world.boxes.push_back(wall({2.35, 2.0}, {2.9, 1.9}, kRoom));
  return world;
}

/// Where the scan plane cuts the outline of the board: two points in the laser frame, or none.
std::vector<Eigen::Vector2d> cut_by_scan(const Eigen::Isometry3d& T_laser_board,
                                         const calibration::BoardOutline& o) {
  const Eigen::Vector3d corners[] = {{o.x_min_m, o.y_min_m, 0},
                                     {o.x_max_m, o.y_min_m, 0},
                                     {o.x_max_m, o.y_max_m, 0},
                                     {o.x_min_m, o.y_max_m, 0}};
  std::vector<Eigen::Vector2d> cut;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d a = T_laser_board * corners[i], b = T_laser_board * corners[(i + 1) % 4];
    if ((a.z() > 0.0) != (b.z() > 0.0)) {
      cut.emplace_back((a + a.z() / (a.z() - b.z()) * (b - a)).head<2>());
    }
  }
  return cut;
}

Eigen::Vector3d middle_of(const calibration::BoardOutline& outline) {
  return {0.5 * (outline.x_min_m + outline.x_max_m), 0.5 * (outline.y_min_m + outline.y_max_m),
          0.0};
}

calibration::BoardConfig board_of(const BoardSceneConfig& config) {
  calibration::BoardConfig board;
  board.columns = config.columns;
  board.rows = config.rows;
  board.square_m = config.square_m;
  board.margin_m = config.margin_m;
  return board;
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

BoardScene::BoardScene(std::uint64_t seed, const RigConfig& rig)
    : seed_(seed),
      rig_(rig),
      config_(rig.simulation.board),
      board_(board_of(config_)),
      outline_(calibration::outline_of(board_)),
      camera_(rig.camera.intrinsics),
      painter_(rig.camera.intrinsics, board_) {
  const geometry::LaserToCamera mount(rig.camera.extrinsics);
  T_camera_laser_ = isometry(mount.rotation(), mount.translation_m());
  Random targets(seed, Stream::kTargets);
  lasting_error_ = targets.normal(0.0, rig.simulation.scanner.target_sd_fraction);
  Random places(seed, Stream::kScene);
  while (static_cast<int>(poses_.size()) < config_.num_poses) {
    std::optional<Eigen::Isometry3d> pose;
    for (int attempt = 0; attempt < 3000 && !pose; ++attempt) {
      pose = draw_pose(places);
    }
    if (!pose) {
      throw std::invalid_argument(
          "simulation.board: no pose of the board is entirely in the picture and cut by the scan "
          "plane; make the board smaller, or range_max_m larger");
    }
    poses_.push_back(*pose);
  }
}

bool BoardScene::wholly_in_picture(const Eigen::Isometry3d& T_camera_board) const {
  constexpr double kBorder_px = 3.0;
  for (const double x : {-board_.square_m, board_.columns * board_.square_m}) {
    for (const double y : {-board_.square_m, board_.rows * board_.square_m}) {
      const auto pixel = camera_.project(T_camera_board * Eigen::Vector3d(x, y, 0.0));
      if (!pixel || pixel->x() < kBorder_px || pixel->y() < kBorder_px ||
          pixel->x() > rig_.camera.intrinsics.width_px - 1 - kBorder_px ||
          pixel->y() > rig_.camera.intrinsics.height_px - 1 - kBorder_px) {
        return false;
      }
    }
  }
  return true;
}

std::optional<Eigen::Isometry3d> BoardScene::draw_pose(Random& random) const {
  const double range_m = random.uniform(config_.range_min_m, config_.range_max_m);
  const double bearing_rad = random.uniform(-0.6, 0.6);
  // In the laser frame, so that the scan plane cuts the board well inside its edges.
  const Eigen::Vector3d middle_laser(
      range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad),
      random.uniform(-0.3, 0.3) * (outline_.y_max_m - outline_.y_min_m));
  const Eigen::Vector3d middle = T_camera_laser_ * middle_laser;

  const double tilt = config_.tilt_max_rad;
  const double turn_y = random.uniform(-tilt, tilt), lean_x = random.uniform(-tilt, tilt);
  const double roll_z = random.uniform(-0.35, 0.35);
  if (std::hypot(turn_y, lean_x) > tilt) return std::nullopt;
  // Tilts from the line of sight.
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(std::atan2(middle.x(), middle.z()) + turn_y, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(lean_x, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(roll_z, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::Isometry3d T = isometry(R, middle - R * middle_of(outline_));
  if (!wholly_in_picture(T)) return std::nullopt;
  return T;
}

double BoardScene::duration_s() const {
  return config_.num_poses * (config_.hold_s + config_.move_s);
}

Eigen::Isometry3d BoardScene::pose_at(double time_s, std::uint64_t index) const {
  const double period_s = config_.hold_s + config_.move_s;
  const auto number = std::min(poses_.size() - 1, static_cast<std::size_t>(time_s / period_s));
  const double into_s = time_s - static_cast<double>(number) * period_s;
  Eigen::Isometry3d T = poses_[number];
  if (into_s > config_.hold_s && number + 1 < poses_.size()) {
    const double fraction = (into_s - config_.hold_s) / config_.move_s;
    const Eigen::Quaterniond from(poses_[number].linear()), to(poses_[number + 1].linear());
    T = isometry(from.slerp(fraction, to).toRotationMatrix(),
                 (1.0 - fraction) * poses_[number].translation() +
                     fraction * poses_[number + 1].translation());
  }
  Random random(seed_, Stream::kBench, index);
  const Eigen::Vector3d turn(random.normal(), random.normal(), random.normal());
  const Eigen::Vector3d shift(random.normal(), random.normal(), random.normal());
  const double angle_rad = std::max(1e-12, config_.tremor_rad * turn.norm());
  T.linear() = Eigen::AngleAxisd(angle_rad, turn.normalized()).toRotationMatrix() * T.linear();
  T.translation() += config_.tremor_m * shift;
  return T;
}

laser::Scan BoardScene::scan(const Eigen::Isometry3d& T_camera_board, std::uint64_t index) const {
  const Eigen::Isometry3d T_laser_board = T_camera_laser_.inverse() * T_camera_board;
  World world = room();
  const auto cut = cut_by_scan(T_laser_board, outline_);
  if (cut.size() == 2) world.boxes.push_back(wall(cut[0], cut[1], kBoard));
  const Eigen::Vector2d middle = (T_laser_board * middle_of(outline_)).head<2>();
  const Eigen::Vector2d away = middle.normalized();
  const Eigen::Vector2d person = middle + 0.5 * away;
  const Eigen::Vector2d side = 0.14 * Eigen::Vector2d(-away.y(), away.x());
  for (const Target leg : {kLeftLeg, kRightLeg}) {
    const Eigen::Vector2d p = person + (leg == kLeftLeg ? 1.0 : -1.0) * side;
    world.cylinders.push_back({p.x(), p.y(), 0.065, 10.0, 0.0, leg, {}});
  }
  Random random(seed_, Stream::kScan, index);
  return simulate_scan(world, {Pose2{}}, rig_.simulation.scanner, {lasting_error_}, random);
}

calibration::GreyPicture BoardScene::picture(const Eigen::Isometry3d& T_camera_board,
                                             std::uint64_t index) const {
  Random random(seed_, Stream::kImage, index);
  return painter_.take(T_camera_board, random);
}

vision::Image BoardScene::image(double time_s, std::uint64_t index) const {
  calibration::GreyPicture picture = this->picture(pose_at(time_s, 2 * index + 1), index);
  cv::Mat grey(picture.height_px, picture.width_px, CV_8UC1, picture.grey.data());
  cv::Mat colour;
  cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  vision::Image image;
  image.width_px = picture.width_px;
  image.height_px = picture.height_px;
  image.encoding = vision::Encoding::kJpeg;
  vision::PixelBlock pixels;
  pixels.area = {0, 0, picture.width_px, picture.height_px};
  pixels.bgr.assign(colour.datastart, colour.dataend);
  image.data =
      vision::write_jpeg(pixels, rig_.simulation.image.jpeg_quality, vision::JpegTransform::kExact);
  return image;
}

std::optional<std::variant<laser::Scan, vision::Image>> BoardScene::next() {
  const double scan_s = static_cast<double>(next_[0]) / rig_.simulation.scanner.rate_hz;
  const double image_s = static_cast<double>(next_[1]) / rig_.simulation.image.rate_hz +
                         rig_.simulation.image.offset_s;
  const double time_s = std::min(scan_s, image_s);
  if (time_s >= duration_s()) return std::nullopt;
  const auto stamp = [&](auto message, std::uint64_t index) {
    message.utime = kEpochUtime + std::llround(time_s * 1e6);
    message.seq = static_cast<std::int32_t>(index);
    return std::variant<laser::Scan, vision::Image>(std::move(message));
  };
  if (scan_s <= image_s) {
    const std::uint64_t index = next_[0]++;
    return stamp(scan(pose_at(time_s, 2 * index), index), index);
  }
  const std::uint64_t index = next_[1]++;
  return stamp(image(time_s, index), index);
}

}  // namespace orchard::simulation
