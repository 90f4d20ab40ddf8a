// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The tuned constants of calibration: chosen by trying. Those of this room that are not here are
/// physical or derived, and say from what.
namespace orchard::calibration::tuning {

// On simulated pictures of boards.

/// Images up to this width are also searched at twice their size [px].
inline constexpr int kSmall_px = 800;

// On simulated boards before laser and camera (scene `board`).

/// Step of the grid of rotations [rad]; 12 degrees.
inline constexpr double kGrid_rad = 0.21;
/// Limit of n . R l on the grid.
inline constexpr double kDirectionGate = 0.25;
/// Number of rotations to refine.
inline constexpr int kMaxStarts = 60;
/// Initial and final gate of a line's distance from the board.
inline constexpr double kWideGate_m = 0.30;
inline constexpr double kGate_m = 0.04;
/// Lower limit of the gate for rivals.
inline constexpr double kMinRivalGate_m = 0.01;
/// Max distance of a line's middle outside the board.
inline constexpr double kOutsideBoard_m = 0.06;
/// Mounts closer than these are the same.
inline constexpr double kSameRotation_rad = 0.17;
inline constexpr double kSameShift_m = 0.10;
/// Beams beyond this many sigmas are down-weighted.
inline constexpr double kHuber = 2.5;
/// Max distance of a line end from an edge of the board.
inline constexpr double kEdgeGate_m = 0.05;
/// Below this largest angle between two boards all count as parallel.
inline constexpr double kHardlyTilted_deg = 16.0;

// On simulated drives in curves with a delayed camera.

/// Widths of the vote and of the robust weight.
inline constexpr double kVoteWidth_px = 2.0;
inline constexpr double kTukey_px = 3.0;
/// Min roc of an image edge that is compared with the laser's; weaker lines are texture and
/// background.
inline constexpr double kEdgeRocMin = 0.5;
/// Tolerance of the width in the image against the laser's, beside a beam step and a pixel.
inline constexpr double kWidthToleranceFraction = 0.15;
/// Min inlier fraction; smaller ones occur by chance.
inline constexpr double kAgreeingMin = 0.4;

// On simulated orchards (config/orchard.yaml, config/orchard_hard.yaml).

/// Max difference of two trunks' colours in the logs of blue and of red over green. Light of 5500
/// and of 10000 K (sun, open shade) differs by 0.3, bark of saturation 0.04 and of 0.42 by 0.4;
/// both together by 0.5. The hue of bark so pale says nothing; painted objects differ by 1 and
/// more.
inline constexpr double kSameColour = 0.5;
/// Min number of observations of a trunk relative to that of its kind's typical observation.
/// Somebody who walks past leaves one short-lived object after another, all of the same width.
inline constexpr double kLookedAtMin = 0.5;
/// Somebody who walks is observed at positions that scatter more than those of the trunks by at
/// least this factor.
inline constexpr double kWalkingFactor = 3.0;
/// Probability of being a trunk below which an object is a negative example.
inline constexpr double kSurelyNone = 0.1;

}  // namespace orchard::calibration::tuning
