// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "geometry/laser_camera.hpp"

namespace orchard::calibration {

/// Which axes the laser has in what is imported.
enum class LaserAxes {
  kToolbox,  ///< x left, y up, z forward: Kassir and Peynot's, the scan in the x-z plane
  kOrchard,  ///< x forward, y left, z up: ours, as the rig's YAML has it
};

enum class AngleUnit { kAsStated, kDegrees, kRadians };

/// The extrinsics in what Kassir and Peynot's toolbox (ACRA 2010) prints at the end, as text:
///
///     Delta = [0.0308 -0.0652 -0.0796] +- [...] m
///     Phi = [-0.105 -3.53 -179] +- [...] deg
///
/// `delta` and `phi` in any case, "=" or ":", numbers with spaces, commas or semicolons, on one
/// line or several; what follows the three numbers' bracket is not read but for the words deg and
/// rad. Angles are those of the paper's eq. 2. Throws std::runtime_error with one clause when a
/// part is missing, when the angles' unit is neither stated nor given, and when under these axes
/// the camera would not look where the scanner looks forward.
geometry::LaserCameraExtrinsics import_mount(const std::string& text, LaserAxes axes,
                                             AngleUnit unit);

}  // namespace orchard::calibration
