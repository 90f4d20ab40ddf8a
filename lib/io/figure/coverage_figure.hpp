// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibration/board/camera_calibration.hpp"

namespace orchard::io {

/// A PNG of the camera's picture: where corners of the board were seen, each with an arrow to where
/// the model has it (lengthened; the scale is written below), and the principal point.
std::string coverage_figure_png(const calibration::CameraCalibration& calibration);

}  // namespace orchard::io
