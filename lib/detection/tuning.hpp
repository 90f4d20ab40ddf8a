// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The tuned constants of detection: chosen by trying. Those of this room that are not here are
/// physical or derived, and say from what.
namespace orchard::detection::tuning {

// On the simulated orchard, seeds 1001 and up (config/orchard_hard.yaml), and its drives with a
// camera turned by 1 to 3 degrees.

/// Min roc of an image edge that is compared with the laser's; weaker lines are texture and
/// background.
inline constexpr double kEdgeRocMin = 0.5;
/// Tolerance of the width in the image against the laser's, beside a beam step and a pixel.
inline constexpr double kWidthToleranceFraction = 0.15;
/// Search window: largest disagreement of laser and image edges that can be found [deg].
inline constexpr double kSearchWindow_deg = 4.0;
/// Window of the running median in message time [s]; longer than a single object stays in view.
inline constexpr double kDisagreementWindow_s = 20.0;
/// Min number of observations for a median.
inline constexpr int kObjectsMin = 20;
/// Disagreement that raises the warning [deg], once the median is certain to reach it, and below
/// which it is cleared.
inline constexpr double kWarn_deg = 0.75;
inline constexpr double kClear_deg = 0.5;

}  // namespace orchard::detection::tuning
