// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/board_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "geometry/camera_model.hpp"
#include "simulation/simulator.hpp"
#include "vision/jpeg_writer.hpp"

namespace orchard::simulation {
namespace {

constexpr double kNoHit = std::numeric_limits<double>::infinity();
constexpr int kNumRays = 9;              ///< across a spot
constexpr double kSameSurface_m = 0.10;  ///< max range difference of rays on one surface
constexpr double kDeg = 3.14159265358979323846 / 180.0;

Eigen::Isometry3d isometry(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = t;
  return T;
}

struct Wall {
  Eigen::Vector2d from_m, to_m;
};

/// The room and a cupboard in it, laser frame.
const std::vector<Wall>& room() {
  static const std::vector<Wall> walls{
      {{3.1, -2.6}, {3.3, 2.7}},   {{3.3, 2.7}, {-2.0, 2.9}}, {{-2.0, 2.9}, {-2.1, -2.5}},
      {{-2.1, -2.5}, {3.1, -2.6}}, {{2.2, 1.4}, {2.35, 2.0}}, {{2.35, 2.0}, {2.9, 1.9}},
  };
  return walls;
}

double ray_wall(const Eigen::Vector2d& ray, const Wall& wall) {
  const Eigen::Vector2d along = wall.to_m - wall.from_m;
  const double cross = ray.x() * along.y() - ray.y() * along.x();
  if (std::abs(cross) < 1e-12) return kNoHit;
  const double range_m = (wall.from_m.x() * along.y() - wall.from_m.y() * along.x()) / cross;
  const double fraction = (wall.from_m.x() * ray.y() - wall.from_m.y() * ray.x()) / cross;
  return range_m > 0.0 && fraction >= 0.0 && fraction <= 1.0 ? range_m : kNoHit;
}

double ray_leg(const Eigen::Vector2d& ray, const Eigen::Vector2d& centre, double radius_m) {
  const double along_m = ray.dot(centre);
  const double across_m = ray.x() * centre.y() - ray.y() * centre.x();
  const double inside = radius_m * radius_m - across_m * across_m;
  return inside < 0.0 || along_m <= 0.0 ? kNoHit : along_m - std::sqrt(inside);
}

/// Range at which a ray of the scan plane meets the board.
double ray_board(const Eigen::Vector2d& ray, const Eigen::Isometry3d& T_board_laser,
                 const calibration::BoardOutline& outline) {
  const Eigen::Vector3d origin = T_board_laser.translation();
  const Eigen::Vector3d direction = T_board_laser.linear() * Eigen::Vector3d(ray.x(), ray.y(), 0);
  if (std::abs(direction.z()) < 1e-9) return kNoHit;
  const double range_m = -origin.z() / direction.z();
  if (range_m <= 0.0) return kNoHit;
  const Eigen::Vector3d p = origin + range_m * direction;
  const bool on = p.x() >= outline.x_min_m && p.x() <= outline.x_max_m &&
                  p.y() >= outline.y_min_m && p.y() <= outline.y_max_m;
  return on ? range_m : kNoHit;
}

enum Surface { kBoard, kLeftLeg, kRightLeg, kRoom, kNumSurfaces };

struct Hit {
  double range_m = kNoHit;
  int surface = kRoom;
};

/// Range measured by a spot: of the surface that fills more than half of it, or a mixture of two.
Hit read_spot(const std::array<Hit, kNumRays>& rays, bool mixes) {
  const Hit nearest = *std::min_element(
      rays.begin(), rays.end(), [](const Hit& a, const Hit& b) { return a.range_m < b.range_m; });
  double near_sum_m = 0.0, far_sum_m = 0.0;
  int num_near = 0, num_far = 0, far_surface = kRoom;
  for (const Hit& ray : rays) {
    if (ray.range_m == kNoHit) continue;
    if (ray.range_m < nearest.range_m + kSameSurface_m) {
      near_sum_m += ray.range_m;
      ++num_near;
    } else {
      far_sum_m += ray.range_m;
      far_surface = ray.surface;
      ++num_far;
    }
  }
  if (mixes && num_near > kNumRays / 4 && num_far > kNumRays / 4) {
    return {(near_sum_m + far_sum_m) / (num_near + num_far), nearest.surface};
  }
  if (num_near > kNumRays / 2) return {near_sum_m / num_near, nearest.surface};
  if (num_far > kNumRays / 2) return {far_sum_m / num_far, far_surface};
  return {};
}

calibration::BoardConfig board_of(const BoardSceneConfig& config) {
  calibration::BoardConfig board;
  board.kind = calibration::BoardConfig::kChessboard;
  board.columns = config.columns;
  board.rows = config.rows;
  board.square_m = config.square_m;
  board.margin_m = config.margin_m;
  return board;
}

}  // namespace

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
      pose = draw_pose(poses_.size(), places);
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

std::optional<Eigen::Isometry3d> BoardScene::draw_pose(std::size_t number, Random& random) const {
  if (config_.handling == BoardHandling::kStill && !poses_.empty()) return poses_.front();
  const double range_m = random.uniform(config_.range_min_m, config_.range_max_m);
  const double bearing_rad = random.uniform(-0.6, 0.6);
  // In the laser frame, so that the scan plane cuts the board well inside its edges.
  Eigen::Vector3d middle_laser(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad),
                               random.uniform(-0.3, 0.3) * (outline_.y_max_m - outline_.y_min_m));
  if (config_.seen_by == BoardVisibility::kCameraOnly) middle_laser.z() = random.uniform(0.5, 0.7);
  const Eigen::Vector3d middle = T_camera_laser_ * middle_laser;

  const double tilt = config_.tilt_max_rad;
  double turn_y = random.uniform(-tilt, tilt), lean_x = random.uniform(-tilt, tilt);
  double roll_z = random.uniform(-0.35, 0.35);
  const auto jitter = [&] { return random.normal(0.0, 0.4 * kDeg); };  // of a hand
  switch (config_.handling) {
    case BoardHandling::kCareful:
      if (std::hypot(turn_y, lean_x) > tilt) return std::nullopt;
      break;
    case BoardHandling::kSmallTilts:
      turn_y *= 5.0 * kDeg / tilt;
      lean_x *= 5.0 * kDeg / tilt;
      break;
    case BoardHandling::kTurnedOnly:
      lean_x = jitter();
      break;
    case BoardHandling::kLeanedOnly:
      turn_y = jitter();
      break;
    case BoardHandling::kTwoOrientations:
      turn_y = (number % 2 == 0 ? 0.45 : -0.35) + jitter();
      lean_x = (number % 2 == 0 ? -0.3 : 0.25) + jitter();
      roll_z = 0.1;
      break;
    case BoardHandling::kParallel:
    case BoardHandling::kStill:
      turn_y = jitter();
      lean_x = jitter();
      break;
  }
  // Tilts about the camera's own axes; kCareful tilts from the line of sight.
  Eigen::Matrix3d R = (Eigen::AngleAxisd(turn_y, Eigen::Vector3d::UnitY()) *
                       Eigen::AngleAxisd(lean_x, Eigen::Vector3d::UnitX()))
                          .toRotationMatrix();
  if (config_.handling == BoardHandling::kCareful) {
    const double side = std::atan2(middle.x(), middle.z());
    R = Eigen::AngleAxisd(side, Eigen::Vector3d::UnitY()).toRotationMatrix() * R;
  }
  R = R * Eigen::AngleAxisd(roll_z, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d board_middle(0.5 * (outline_.x_min_m + outline_.x_max_m),
                                     0.5 * (outline_.y_min_m + outline_.y_max_m), 0.0);
  Eigen::Isometry3d T = isometry(R, middle - R * board_middle);
  if (config_.seen_by == BoardVisibility::kLaserOnly) return T;  // the camera looks elsewhere
  if (!wholly_in_picture(T)) {
    if (config_.seen_by != BoardVisibility::kCameraOnly) return std::nullopt;
    // A board missed by the scan plane must still be in view: higher and farther.
    T.translation().z() += 0.5;
    if (!wholly_in_picture(T)) return std::nullopt;
  }
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
  const ScannerConfig& scanner = rig_.simulation.scanner;
  Random random(seed_, Stream::kScan, index);
  const Eigen::Isometry3d T_board_laser = T_camera_board.inverse() * T_camera_laser_;
  const Eigen::Vector3d board_middle(0.5 * (outline_.x_min_m + outline_.x_max_m),
                                     0.5 * (outline_.y_min_m + outline_.y_max_m), 0.0);
  const Eigen::Vector3d middle = T_board_laser.inverse() * board_middle;
  const Eigen::Vector2d away = middle.head<2>().normalized();
  const Eigen::Vector2d person = middle.head<2>() + 0.5 * away;
  const Eigen::Vector2d side = 0.14 * Eigen::Vector2d(-away.y(), away.x());

  std::array<double, kNumSurfaces> errors{};
  for (double& error : errors) error = random.normal(0.0, scanner.scan_sd_fraction);
  errors[kBoard] += lasting_error_;

  laser::Scan scan;
  scan.bearing_min_rad = scanner.bearing_min_rad;
  scan.bearing_step_rad = scanner.bearing_step_rad;
  scan.beam_period_us = scanner.beam_period_us;
  scan.range_min_m = scanner.range_min_m;
  scan.range_max_m = scanner.range_max_m;
  scan.ranges_m.assign(static_cast<std::size_t>(scanner.num_beams), 0.0f);
  for (int beam = 0; beam < scanner.num_beams; ++beam) {
    const bool mixes = random.uniform() < scanner.mixed_probability;
    const bool lost = random.uniform() < scanner.dropout_probability;
    const double noise = random.normal();
    std::array<Hit, kNumRays> rays;
    for (int k = 0; k < kNumRays; ++k) {
      const double bearing_rad = scanner.bearing_min_rad + beam * scanner.bearing_step_rad +
                                 ((k + 0.5) / kNumRays - 0.5) * scanner.spot_rad;
      const Eigen::Vector2d ray(std::cos(bearing_rad), std::sin(bearing_rad));
      Hit& hit = rays[static_cast<std::size_t>(k)];
      const auto meet = [&hit](double range_m, int surface) {
        if (range_m < hit.range_m) hit = {range_m, surface};
      };
      meet(ray_board(ray, T_board_laser, outline_), kBoard);
      meet(ray_leg(ray, person + side, 0.065), kLeftLeg);
      meet(ray_leg(ray, person - side, 0.065), kRightLeg);
      for (const Wall& wall : room()) meet(ray_wall(ray, wall), kRoom);
    }
    const Hit hit = read_spot(rays, mixes);
    if (hit.range_m == kNoHit || lost) continue;
    const double limit_m =
        hit.range_m < 1.0 ? scanner.limit_m : scanner.limit_fraction * hit.range_m;
    const double error_m = errors[static_cast<std::size_t>(hit.surface)] * hit.range_m +
                           noise * (scanner.beam_sd_m + scanner.beam_sd_fraction * hit.range_m);
    const double range_m = hit.range_m + std::clamp(error_m, -limit_m, limit_m);
    if (range_m < scanner.range_min_m || range_m > scanner.range_max_m) continue;
    scan.ranges_m[static_cast<std::size_t>(beam)] =
        static_cast<float>(std::round(range_m / scanner.resolution_m) * scanner.resolution_m);
  }
  return scan;
}

calibration::GreyPicture BoardScene::picture(const Eigen::Isometry3d& T_camera_board,
                                             std::uint64_t index) const {
  Random random(seed_, Stream::kImage, index);
  std::optional<Eigen::Isometry3d> shown;
  if (config_.seen_by != BoardVisibility::kLaserOnly) shown = T_camera_board;
  return painter_.take(shown, random);
}

vision::Image BoardScene::image(double time_s, std::uint64_t index) const {
  calibration::GreyPicture picture = this->picture(pose_at(time_s, 2 * index + 1), index);
  cv::Mat grey(picture.height_px, picture.width_px, CV_8UC1, picture.grey.data());
  if (config_.flip == PictureFlip::kLeftRight) cv::flip(grey, grey, 1);
  if (config_.flip == PictureFlip::kTopBottom) cv::flip(grey, grey, 0);
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
