// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/coverage_figure.hpp"

#include <algorithm>
#include <cmath>

#include "io/figure/canvas.hpp"
#include "io/fixed_text.hpp"

namespace orchard::io {
namespace {

constexpr double kWidth_px = 960.0;  ///< of the drawing, whatever the camera's
constexpr double kFooter_px = 30.0;
constexpr double kArrow_px = 18.0;  ///< length of an arrow of the root mean square error
constexpr Colour kGrey{205, 205, 205}, kGreen{30, 140, 60}, kRed{200, 40, 30}, kBlack{0, 0, 0};

}  // namespace

std::string coverage_figure_png(const calibration::CameraCalibration& calibration) {
  const geometry::CameraIntrinsics& camera = calibration.intrinsics;
  const double scale = kWidth_px / camera.width_px;
  const double height_px = scale * camera.height_px;
  const auto canvas = make_png_canvas(static_cast<int>(kWidth_px),
                                      static_cast<int>(std::lround(height_px + kFooter_px)));
  const auto place = [scale](double x_px, double y_px) {
    return PixelPoint{(x_px + 0.5) * scale, (y_px + 0.5) * scale};
  };
  constexpr int kParts = 5;
  for (int i = 0; i <= kParts; ++i) {
    const double x = i * kWidth_px / kParts, y = i * height_px / kParts;
    canvas->line({x, 0.0}, {x, height_px}, kGrey, 1.0);
    canvas->line({0.0, y}, {kWidth_px, y}, kGrey, 1.0);
  }
  const double lengthen = kArrow_px / std::max(calibration.rms_px, 1e-6);
  for (const calibration::CornerResidual& corner : calibration.residuals) {
    const PixelPoint at = place(corner.found_px.x_px, corner.found_px.y_px);
    // the model's place is the found one minus the residual
    canvas->line(at, {at.x - lengthen * corner.dx_px, at.y - lengthen * corner.dy_px}, kRed, 1.0);
    canvas->circle(at, 2.0, kGreen, kGreen);
  }
  const PixelPoint centre = place(camera.cc_px[0], camera.cc_px[1]);
  canvas->line({centre.x - 12.0, centre.y}, {centre.x + 12.0, centre.y}, kBlack, 2.0);
  canvas->line({centre.x, centre.y - 12.0}, {centre.x, centre.y + 12.0}, kBlack, 2.0);
  canvas->text({8.0, height_px + 20.0},
               std::to_string(calibration.num_corners) + " corners of " +
                   std::to_string(calibration.num_views) + " views; arrows to the model, " +
                   fixed_text(lengthen / scale, 0) + " times their length (rms " +
                   fixed_text(calibration.rms_px, 3) + " px); cross: principal point",
               16.0, kBlack, TextAnchor::kStart);
  return canvas->bytes();
}

}  // namespace orchard::io
