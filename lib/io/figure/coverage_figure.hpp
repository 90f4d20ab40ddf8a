// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibration/board/camera_calibration.hpp"
#include "io/figure/canvas.hpp"

namespace orchard::io {

/// Draws the camera's picture area in axes of pixels: where corners of the board were seen, each
/// with an arrow to where the model has it (lengthened; the scale is written above), and the
/// principal point. Returns the file.
std::string coverage_figure(const calibration::CameraCalibration& calibration, FigureFormat format);

}  // namespace orchard::io
