// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibration/board/camera_calibration.hpp"
#include "io/figure/canvas.hpp"

namespace orchard::io {

/// Draws the coverage of a calibration in pixel axes: the observed board corners, each with an
/// arrow to its position by the model (enlarged; the scale is given above), and the principal
/// point. Returns the file.
std::string coverage_figure(const calibration::CameraCalibration& calibration, FigureFormat format);

}  // namespace orchard::io
