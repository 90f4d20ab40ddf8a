// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "geometry/camera_model.hpp"

namespace orchard::calibration {

/// Axes of the laser frame in the imported text.
enum class LaserAxes {
  kToolbox,  ///< x left, y up, z forward: Kassir and Peynot's; the scan is in the x-z plane
  kOrchard,  ///< x forward, y left, z up: as in the rig's YAML
};

enum class AngleUnit { kAsStated, kDegrees, kRadians };

/// Reads the extrinsics from the text that Kassir and Peynot's toolbox (ACRA 2010) prints at the
/// end:
///
///     Delta = [0.0308 -0.0652 -0.0796] +- [...] m
///     Phi = [-0.105 -3.53 -179] +- [...] deg
///
/// `delta` and `phi` may be in upper or lower case, followed by "=" or ":"; numbers are separated
/// by spaces, commas or semicolons, on one or more lines. After the three numbers only the words
/// deg and rad are read. Angles are those of the paper's eq. 2. Throws std::runtime_error with one
/// clause when a part is missing, when the unit of the angles is neither stated nor given, and when
/// the camera would not face the scanner's forward direction under these axes.
geometry::LaserCameraExtrinsics import_extrinsics(const std::string& text, LaserAxes axes,
                                                  AngleUnit unit);

}  // namespace orchard::calibration
