// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The tuned constants of vision: chosen by trying. Those of this room that are not here are
/// physical or derived, and say from what.
namespace orchard::vision::tuning {

// On the tubes (config/tubes.yaml, seeds 1001-1020) and the simulated orchard, seeds 1001 and up.

/// Windows with a shorter side count as unseen [px]: too few rows for a line, too few columns for a
/// share.
inline constexpr int kMinWindow_px = 4;
/// Paler pixels, and darker ones, have no hue.
inline constexpr double kSaturationMin = 0.10;
inline constexpr double kValueMin = 0.10;
/// Angle between two edges at which roc_parallel reaches 0 [deg].
inline constexpr double kParallelTolerance_deg = 10.0;

// On photographs 000-019 of apple trunks.

/// Added to a normalised channel before its log: limits the noise of dark pixels.
inline constexpr double kFloor = 0.1;
/// Added to a standard deviation before its log, and to that of a part's variance.
inline constexpr double kSpreadFloor = 0.02;
/// Mean grey level below which a picture is nearly black.
inline constexpr double kGreyLevelsMin = 10.0;

}  // namespace orchard::vision::tuning
