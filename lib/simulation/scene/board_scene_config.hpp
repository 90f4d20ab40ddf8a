// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::simulation {

/// How a person moves a board. kCareful is correct; with each of the others the laser-camera
/// extrinsics are not observable.
enum class BoardHandling {
  kCareful,          ///< different positions and distances, tilts to all sides
  kParallel,         ///< different positions, always parallel to the picture
  kTurnedOnly,       ///< tilted about the camera's y axis only: left and right
  kLeanedOnly,       ///< tilted about the camera's x axis only: forward and back
  kTwoOrientations,  ///< different positions, two orientations
  kStill,            ///< one position, one orientation
  kSmallTilts,       ///< tilts to all sides, by 5 degrees at most
};

/// Sensors that see the board.
enum class BoardVisibility { kBoth, kCameraOnly, kLaserOnly };

/// Mirroring of pictures by a misconfigured camera driver.
enum class PictureFlip { kNone, kLeftRight, kTopBottom };

/// The scene for `orchard calibrate laser-camera`. Section `simulation.board`.
struct BoardSceneConfig {
  int columns = 7;  ///< inner corners of the chessboard
  int rows = 5;
  double square_m = 0.08;
  double margin_m = 0.04;  ///< of white board beyond the outer squares
  int num_poses = 24;
  double hold_s = 0.8;
  double move_s = 0.5;
  double range_min_m = 0.8;    ///< from the laser to the board's middle
  double range_max_m = 1.9;    ///< beyond it, the squares are too small in 320x240 pixels
  double tilt_max_rad = 0.7;   ///< of the board's normal from the line of sight
  double tremor_m = 0.0003;    ///< standard deviation of a still board's position
  double tremor_rad = 0.0005;  ///< standard deviation of its orientation
  BoardHandling handling = BoardHandling::kCareful;
  BoardVisibility seen_by = BoardVisibility::kBoth;
  PictureFlip flip = PictureFlip::kNone;
};

template <class Visitor>
void describe(Visitor& v, BoardSceneConfig& c) {
  v.integer("num_poses", c.num_poses, 1, 1000, "poses",
            "number of poses in which the board is held still");
  v.number("hold_s", c.hold_s, 0.1, 100, "s", "time for which each pose is held");
  v.number("move_s", c.move_s, 0, 100, "s", "time to move from one pose to the next");
  v.choice("handling", c.handling,
           {"careful", "parallel", "turned_only", "leaned_only", "two_orientations", "still",
            "small_tilts"},
           "how the person moves the board");
  v.choice("seen_by", c.seen_by, {"both", "camera_only", "laser_only"},
           "sensors that observe the board");
  v.choice("flip", c.flip, {"none", "left_right", "top_bottom"}, "mirroring of the pictures");
}

}  // namespace orchard::simulation
