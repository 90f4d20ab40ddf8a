// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "calibration/board/board.hpp"
#include "laser/scan.hpp"
#include "simulation/scene/board_picture.hpp"
#include "simulation/scene/board_scene_config.hpp"
#include "simulation/scene/tube_scene.hpp"
#include "vision/image.hpp"

namespace orchard::simulation {

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
  std::optional<Eigen::Isometry3d> draw_pose(std::size_t number, Random& random) const;
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
