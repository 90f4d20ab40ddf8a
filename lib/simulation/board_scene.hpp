// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "calibration/board/board.hpp"
#include "geometry/camera_model.hpp"
#include "laser/scan.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/scenes.hpp"
#include "simulation/simulation_config.hpp"
#include "vision/image.hpp"

namespace orchard::simulation {

/// Light and camera properties of a picture of a board. Grey levels are 0 to 255.
struct BoardPictureConfig {
  double white = 205.0;      ///< of the paper in full light
  double black = 35.0;       ///< of the ink
  double shading = 0.25;     ///< largest change of light from one side of the picture to another
  double clutter = 55.0;     ///< contrast of the background
  double blur_px = 0.6;      ///< standard deviation of the lens' blur
  double noise_sd = 2.0;     ///< of each pixel, grey levels
  int samples_per_side = 4;  ///< rays through a pixel: this number squared
};

/// Renders pictures of a board through a distorting lens. Rays through every part of a pixel meet
/// the board's plane, so the corners agree with the camera model to a few hundredths of a pixel.
class BoardPainter {
 public:
  BoardPainter(const geometry::CameraIntrinsics& camera, const calibration::BoardConfig& board,
               const BoardPictureConfig& config = {});

  /// Renders a board at T_camera_board (its back away from the camera), or the background alone.
  /// The board's back is blank.
  calibration::GreyPicture take(const std::optional<Eigen::Isometry3d>& T_camera_board,
                                Random& random) const;

 private:
  struct Ray {
    float x = 0.0f;  ///< at z = 1 of the camera frame
    float y = 0.0f;
  };

  geometry::CameraIntrinsics camera_;
  calibration::BoardPattern pattern_;
  BoardPictureConfig config_;
  std::vector<Ray> rays_;  ///< samples_per_side^2 per pixel
};

/// Scene of a person who holds a chessboard before a standing robot in a room; gives SCAN and IMAGE
/// from one seed. The scanner sees the board's face or back where the scan plane cuts it, the
/// person's legs behind it, a cupboard of about the board's width and the walls, all with
/// ScannerConfig's errors; the camera sees the chessboard before a cluttered background. The rig's
/// `camera` is the truth.
class BoardScene {
 public:
  BoardScene(std::uint64_t seed, const RigConfig& rig);

  /// The next message in order of time (scans first), or none at the end.
  std::optional<std::variant<laser::Scan, vision::Image>> next();

  double duration_s() const;
  const calibration::BoardConfig& board() const { return board_; }
  /// T_camera_board of the still poses.
  const std::vector<Eigen::Isometry3d>& poses() const { return poses_; }

  /// The sensors' data for a board at one pose; `index` selects their random errors.
  laser::Scan scan(const Eigen::Isometry3d& T_camera_board, std::uint64_t index) const;
  calibration::GreyPicture picture(const Eigen::Isometry3d& T_camera_board,
                                   std::uint64_t index) const;

 private:
  Eigen::Isometry3d pose_at(double time_s, std::uint64_t index) const;
  std::optional<Eigen::Isometry3d> draw_pose(Random& random) const;
  bool wholly_in_picture(const Eigen::Isometry3d& T_camera_board) const;
  vision::Image image(double time_s, std::uint64_t index) const;

  std::uint64_t seed_;
  RigConfig rig_;
  BoardSceneConfig config_;
  calibration::BoardConfig board_;
  calibration::BoardOutline outline_;
  geometry::CameraModel camera_;
  Eigen::Isometry3d T_camera_laser_;
  BoardPainter painter_;
  std::vector<Eigen::Isometry3d> poses_;
  double lasting_error_ = 0.0;           ///< of ranges to the board, as a fraction
  std::array<std::uint64_t, 2> next_{};  ///< scan, image
};

}  // namespace orchard::simulation
