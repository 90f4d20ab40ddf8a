// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/camera_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

struct Solution {
  cv::Mat camera, distortion;
  std::vector<cv::Mat> rotations, places;
  std::vector<double> sd;  ///< fx fy cx cy k1 k2 p1 p2 k3
  std::vector<std::vector<cv::Point2f>> modelled;
  double rms_px = 0.0;
  int num_corners = 0;
};

std::vector<cv::Point3f> places_of(const BoardView& view) {
  std::vector<cv::Point3f> places;
  for (const BoardPoint& p : view.corners_m) {
    places.emplace_back(static_cast<float>(p.x_m), static_cast<float>(p.y_m), 0.0f);
  }
  return places;
}

std::vector<cv::Point2f> pixels_of(const BoardView& view) {
  std::vector<cv::Point2f> pixels;
  for (const ImagePoint& p : view.corners_px) {
    pixels.emplace_back(static_cast<float>(p.x_px), static_cast<float>(p.y_px));
  }
  return pixels;
}

Solution solve(const std::vector<const NamedView*>& views, cv::Size size, bool estimate_k3) {
  std::vector<std::vector<cv::Point3f>> places;
  std::vector<std::vector<cv::Point2f>> pixels;
  Solution solution;
  for (const NamedView* view : views) {
    places.push_back(places_of(view->view));
    pixels.push_back(pixels_of(view->view));
    solution.num_corners += static_cast<int>(pixels.back().size());
  }
  cv::Mat sd_intrinsics, sd_extrinsics, view_errors;
  try {
    solution.rms_px =
        cv::calibrateCamera(places, pixels, size, solution.camera, solution.distortion,
                            solution.rotations, solution.places, sd_intrinsics, sd_extrinsics,
                            view_errors, estimate_k3 ? 0 : cv::CALIB_FIX_K3,
                            {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-12});
  } catch (const cv::Exception&) {
    throw std::runtime_error(
        "the views do not determine the camera; show the board tilted to all sides and at several "
        "distances");
  }
  if (!cv::checkRange(solution.camera) || !cv::checkRange(solution.distortion) ||
      !std::isfinite(solution.rms_px)) {
    throw std::runtime_error("the estimation did not converge; show the board tilted to all sides");
  }
  const int num_parameters = (estimate_k3 ? 9 : 8) + 6 * static_cast<int>(views.size());
  const double freedom = 2.0 * solution.num_corners - num_parameters;
  const double opencv_freedom = static_cast<double>(solution.num_corners) - num_parameters;
  // OpenCV's standard deviation is meaningless with fewer corners than parameters.
  const double correction =
      freedom > 0.0 && opencv_freedom > 0.0 ? std::sqrt(opencv_freedom / freedom) : 1.0;
  for (int i = 0; i < 9; ++i) solution.sd.push_back(correction * sd_intrinsics.at<double>(i));
  for (std::size_t i = 0; i < views.size(); ++i) {
    solution.modelled.emplace_back();
    cv::projectPoints(places[i], solution.rotations[i], solution.places[i], solution.camera,
                      solution.distortion, solution.modelled.back());
  }
  return solution;
}

ViewFigures figures_of(const NamedView& view, const Solution& solution, std::size_t i) {
  ViewFigures figures;
  figures.name = view.name;
  figures.num_corners = static_cast<int>(view.view.corners_px.size());
  double sum_px2 = 0.0;
  BoardPoint middle;
  for (std::size_t k = 0; k < view.view.corners_px.size(); ++k) {
    const ImagePoint& found = view.view.corners_px[k];
    const cv::Point2f& modelled = solution.modelled[i][k];
    sum_px2 += std::pow(found.x_px - modelled.x, 2) + std::pow(found.y_px - modelled.y, 2);
    middle.x_m += view.view.corners_m[k].x_m / figures.num_corners;
    middle.y_m += view.view.corners_m[k].y_m / figures.num_corners;
  }
  figures.rms_px = std::sqrt(sum_px2 / figures.num_corners);
  cv::Matx33d R_camera_board;
  cv::Rodrigues(solution.rotations[i], R_camera_board);
  figures.lean = {R_camera_board(0, 2), R_camera_board(1, 2)};
  figures.tilt_rad = std::acos(std::clamp(std::abs(R_camera_board(2, 2)), 0.0, 1.0));
  const cv::Vec3d place(solution.places[i].at<double>(0), solution.places[i].at<double>(1),
                        solution.places[i].at<double>(2));
  figures.distance_m = cv::norm(R_camera_board * cv::Vec3d(middle.x_m, middle.y_m, 0.0) + place);
  return figures;
}

double median_rms_px(const std::vector<const NamedView*>& views, const Solution& solution) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < views.size(); ++i) {
    errors.push_back(figures_of(*views[i], solution, i).rms_px);
  }
  return geometry::median(std::move(errors));
}

/// The view with the largest error, if it is an outlier.
std::ptrdiff_t worst_outlier(const std::vector<const NamedView*>& views, const Solution& solution,
                             const CameraCalibrationOptions& options) {
  double limit_px =
      std::max(options.outlier_floor_px, options.outlier_factor * median_rms_px(views, solution));
  std::ptrdiff_t worst = -1;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double rms_px = figures_of(*views[i], solution, i).rms_px;
    if (rms_px <= limit_px) continue;
    limit_px = rms_px;
    worst = static_cast<std::ptrdiff_t>(i);
  }
  return worst;
}

/// Figures of an outlier under the final intrinsics; only its pose is fitted.
ViewFigures figures_of_outlier(const NamedView& view, const Solution& camera) {
  Solution alone;
  cv::Mat rotation, place;
  cv::solvePnP(places_of(view.view), pixels_of(view.view), camera.camera, camera.distortion,
               rotation, place);
  alone.rotations = {rotation};
  alone.places = {place};
  alone.modelled.emplace_back();
  cv::projectPoints(places_of(view.view), rotation, place, camera.camera, camera.distortion,
                    alone.modelled.back());
  ViewFigures figures = figures_of(view, alone, 0);
  figures.used = false;
  return figures;
}

}  // namespace

CameraCalibration calibrate_camera(const std::vector<NamedView>& views, int width_px, int height_px,
                                   const CameraCalibrationOptions& options) {
  if (views.size() < kMinViews) {
    throw std::runtime_error("the board was found in " + std::to_string(views.size()) +
                             " pictures, but at least " + std::to_string(kMinViews) +
                             ", better 20, are needed");
  }
  std::vector<const NamedView*> used;
  for (const NamedView& view : views) used.push_back(&view);
  Solution solution = solve(used, {width_px, height_px}, options.estimate_k3);
  while (used.size() > kMinViews) {
    const std::ptrdiff_t worst = worst_outlier(used, solution, options);
    if (worst < 0) break;
    used.erase(used.begin() + worst);
    solution = solve(used, {width_px, height_px}, options.estimate_k3);
  }

  CameraCalibration result;
  result.intrinsics.width_px = width_px;
  result.intrinsics.height_px = height_px;
  result.intrinsics.fc_px = {solution.camera.at<double>(0, 0), solution.camera.at<double>(1, 1)};
  result.intrinsics.cc_px = {solution.camera.at<double>(0, 2), solution.camera.at<double>(1, 2)};
  for (int i = 0; i < 5; ++i) {
    const auto k = static_cast<std::size_t>(i);
    result.intrinsics.kc[k] = solution.distortion.at<double>(i);
    result.kc_sd[k] = solution.sd[4 + k];
  }
  result.fc_sd_px = {solution.sd[0], solution.sd[1]};
  result.cc_sd_px = {solution.sd[2], solution.sd[3]};
  result.rms_px = solution.rms_px;
  result.num_views = static_cast<int>(used.size());
  result.num_corners = solution.num_corners;
  std::size_t next = 0;
  for (const NamedView& view : views) {
    if (next >= used.size() || used[next] != &view) {
      result.views.push_back(figures_of_outlier(view, solution));
      continue;
    }
    result.views.push_back(figures_of(view, solution, next));
    for (std::size_t k = 0; k < view.view.corners_px.size(); ++k) {
      const ImagePoint& found = view.view.corners_px[k];
      const cv::Point2f& modelled = solution.modelled[next][k];
      result.residuals.push_back({found, found.x_px - modelled.x, found.y_px - modelled.y});
    }
    ++next;
  }
  return result;
}

}  // namespace orchard::calibration
