// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/coverage_figure.hpp"

#include <algorithm>
#include <cmath>

#include "io/figure/plot_axes.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr double kPictureWidth_px = 960.0;  ///< of the camera's image, for any resolution
constexpr double kTop_px = 68.0;
constexpr double kArrow_px = 18.0;  ///< length of an arrow for the root mean square error
constexpr Colour kCorner{30, 140, 60}, kArrow{200, 40, 30};

void draw_cross(PixelPoint at, Canvas& canvas) {
  constexpr double kArm_px = 9.0;
  canvas.line({at.x - kArm_px, at.y}, {at.x + kArm_px, at.y}, kBlack, 2.0);
  canvas.line({at.x, at.y - kArm_px}, {at.x, at.y + kArm_px}, kBlack, 2.0);
}

}  // namespace

std::string coverage_figure(const calibration::CameraCalibration& calibration,
                            FigureFormat format) {
  const geometry::CameraIntrinsics& camera = calibration.intrinsics;
  const double scale = kPictureWidth_px / camera.width_px;
  const PixelBox box{PlotAxes::kLeftPx, kTop_px, PlotAxes::kLeftPx + kPictureWidth_px,
                     kTop_px + scale * camera.height_px};
  // Pixel centres are at whole numbers; rows count downward.
  const PlotAxes axes(box, {-0.5, camera.width_px - 0.5}, {camera.height_px - 0.5, -0.5});
  Canvas canvas(format, static_cast<int>(std::ceil(box.x1 + PlotAxes::kRightPx)),
                static_cast<int>(std::ceil(box.y1 + PlotAxes::kBottomPx)));
  axes.draw("column (px)", "row (px)", canvas);
  const double lengthen = kArrow_px / (scale * std::max(calibration.rms_px, 1e-6));
  for (const calibration::CornerResidual& corner : calibration.residuals) {
    const Eigen::Vector2d found = corner.found_px;
    const Eigen::Vector2d modelled = found - lengthen * corner.residual_px;
    canvas.line(axes.at(found.x(), found.y()), axes.at(modelled.x(), modelled.y()), kArrow, 1.0);
    canvas.circle(axes.at(found.x(), found.y()), 2.0, kCorner, kCorner);
  }
  draw_cross(axes.at(camera.cc_px[0], camera.cc_px[1]), canvas);
  canvas.text({box.x0, 26.0},
              std::to_string(calibration.num_corners) + " corners of " +
                  std::to_string(calibration.num_views) + " views, rms " +
                  fixed_text(calibration.rms_px, 3) + " px",
              {16.0, kBlack});
  const auto dot = [](PixelPoint at, Canvas& c) { c.circle(at, 2.0, kCorner, kCorner); };
  Legend({{"corner found", dot},
          line_item("error of the model, " + fixed_text(lengthen, 0) + " times enlarged", kArrow),
          {"principal point", draw_cross}},
         box.width())
      .draw({box.x0, 36.0}, canvas);
  return canvas.finish();
}

}  // namespace orchard::io
