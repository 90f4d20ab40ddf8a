// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/camera_calibration.hpp"

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
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
  for (const auto& p : view.corners_m) places.emplace_back(p.x(), p.y(), 0.0f);
  return places;
}

std::vector<cv::Point2f> pixels_of(const BoardView& view) {
  std::vector<cv::Point2f> pixels;
  for (const auto& p : view.corners_px) pixels.emplace_back(p.x(), p.y());
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

Eigen::Vector2d in_eigen(const cv::Point2f& p) { return {p.x, p.y}; }

ViewFigures figures_of(const NamedView& view, const Solution& solution, std::size_t i) {
  ViewFigures figures;
  figures.name = view.name;
  figures.num_corners = static_cast<int>(view.view.corners_px.size());
  double sum_px2 = 0.0;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < view.view.corners_px.size(); ++k) {
    sum_px2 += (view.view.corners_px[k] - in_eigen(solution.modelled[i][k])).squaredNorm();
    middle += view.view.corners_m[k] / figures.num_corners;
  }
  figures.rms_px = std::sqrt(sum_px2 / figures.num_corners);
  cv::Matx33d R_camera_board;
  cv::Rodrigues(solution.rotations[i], R_camera_board);
  figures.lean = {R_camera_board(0, 2), R_camera_board(1, 2)};
  figures.tilt_rad = std::acos(std::clamp(std::abs(R_camera_board(2, 2)), 0.0, 1.0));
  const cv::Vec3d place(solution.places[i].at<double>(0), solution.places[i].at<double>(1),
                        solution.places[i].at<double>(2));
  figures.distance_m = cv::norm(R_camera_board * cv::Vec3d(middle.x(), middle.y(), 0.0) + place);
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
    result.corners_px.insert(result.corners_px.end(), view.view.corners_px.begin(),
                             view.view.corners_px.end());
    ++next;
  }
  return result;
}

namespace {

/// Position, size and tilt of the board in a view; each number varies by about 1.
std::vector<double> observation_of(const BoardView& view, int width_px, int height_px) {
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
  double extent_m = 0.0;
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    middle_px += view.corners_px[i] / static_cast<double>(view.corners_px.size());
    extent_m = std::max(extent_m, view.corners_m[i].lpNorm<Eigen::Infinity>());
  }
  std::vector<cv::Point2f> board = pixels_of({view.corners_m, {}}), picture = pixels_of(view);
  for (cv::Point2f& place : board) place /= extent_m;
  for (cv::Point2f& pixel : picture) pixel /= width_px;
  std::vector<double> observation{2.0 * middle_px.x() / width_px, 2.0 * middle_px.y() / height_px,
                                  0.0, 0.0, 0.0};
  const cv::Mat H = cv::findHomography(board, picture);
  if (H.empty()) return observation;
  const double size =
      std::abs(H.at<double>(0, 0) * H.at<double>(1, 1) - H.at<double>(0, 1) * H.at<double>(1, 0));
  observation[2] = 0.5 * std::log(std::max(size, 1e-6));
  // Perspective: relative distance of the two ends of the board.
  observation[3] = 3.0 * std::clamp(H.at<double>(2, 0), -1.0, 1.0);
  observation[4] = 3.0 * std::clamp(H.at<double>(2, 1), -1.0, 1.0);
  return observation;
}

}  // namespace

std::vector<std::size_t> select_spread(const std::vector<NamedView>& views, int width_px,
                                       int height_px, std::size_t count) {
  std::vector<std::vector<double>> places;
  for (const NamedView& view : views) {
    places.push_back(observation_of(view.view, width_px, height_px));
  }
  return most_different(places, count);
}

namespace {

constexpr double kDegPerRad = 180.0 / geometry::kPi;  // derived: degrees of a radian

class Judge {
 public:
  Judge(const CameraCalibration& calibration, const CameraAcceptanceLimits& rules)
      : calibration_(calibration), rules_(rules), camera_(calibration.intrinsics) {}

  std::vector<std::string> reasons() {
    judge_views();
    judge_coverage();
    judge_tilt();
    judge_distance();
    judge_error();
    judge_spread();
    judge_camera();
    return std::move(reasons_);
  }

 private:
  template <class... Values>
  void refuse(const char* format, const Values&... values) {
    reasons_.push_back(fmt::format(fmt::runtime(format), values...));
  }

  void judge_views() {
    if (calibration_.num_views < rules_.min_views) {
      refuse("too few views: {} of the board are used, but {} are needed, better 20",
             calibration_.num_views, rules_.min_views);
    }
    const std::size_t all = calibration_.views.size();
    const std::size_t outliers = all - static_cast<std::size_t>(calibration_.num_views);
    if (static_cast<double>(outliers) > rules_.max_outlier_fraction * static_cast<double>(all)) {
      refuse(
          "too many outliers: {} of {} views disagree with the others; check that the board is "
          "flat, and hold it still",
          outliers, all);
    }
  }

  void judge_coverage() {
    const CameraCoverage coverage =
        coverage_of(calibration_, rules_.grid_columns, rules_.grid_rows);
    const int right = coverage.columns - 1, bottom = coverage.rows - 1;
    const std::array<std::pair<int, const char*>, 4> corners{
        {{0, "upper left"},
         {right, "upper right"},
         {bottom * coverage.columns, "lower left"},
         {bottom * coverage.columns + right, "lower right"}}};
    std::vector<const char*> empty;
    for (const auto& [cell, name] : corners) {
      if (coverage.corners[static_cast<std::size_t>(cell)] == 0) empty.push_back(name);
    }
    if (!empty.empty()) {
      refuse(
          "the board was never seen in the {} corner{} of the picture, where the lens bends most; "
          "show it there",
          fmt::join(empty, ", "), empty.size() > 1 ? "s" : "");
    }
    if (coverage.fraction() < rules_.min_coverage) {
      refuse(
          "only {:.0f} % of the picture was covered by the board, but {:.0f} % are needed; move "
          "the board over the whole picture",
          100.0 * coverage.fraction(), 100.0 * rules_.min_coverage);
    }
  }

  void judge_tilt() {
    int tilted = 0;
    double largest_rad = 0.0;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const ViewFigures& view : calibration_.views) {
      if (!view.used) continue;
      tilted += view.tilt_rad >= rules_.min_tilt_rad;
      largest_rad = std::max(largest_rad, view.tilt_rad);
      mean += Eigen::Vector2d(view.lean[0], view.lean[1]) / calibration_.num_views;
    }
    if (tilted < rules_.min_tilted) {
      return refuse(
          "the tilt is too small: {} views are tilted by {:.0f} degrees or more (max {:.0f}), {} "
          "are needed; without tilt the focal length is not determined",
          tilted, kDegPerRad * rules_.min_tilt_rad, kDegPerRad * largest_rad, rules_.min_tilted);
    }
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (const ViewFigures& view : calibration_.views) {
      if (!view.used) continue;
      const Eigen::Vector2d lean = Eigen::Vector2d(view.lean[0], view.lean[1]) - mean;
      spread += lean * lean.transpose() / calibration_.num_views;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(spread);
    if (std::sqrt(std::max(0.0, axes.eigenvalues()(0))) < rules_.min_lean_spread) {
      const bool side = std::abs(axes.eigenvectors()(0, 0)) > std::abs(axes.eigenvectors()(1, 0));
      refuse("the board was never tilted {}; tilt it to all four sides",
             side ? "to the left and right" : "up and down");
    }
  }

  void judge_distance() {
    double nearest_m = 1e9, farthest_m = 0.0;
    for (const ViewFigures& view : calibration_.views) {
      if (!view.used) continue;
      nearest_m = std::min(nearest_m, view.distance_m);
      farthest_m = std::max(farthest_m, view.distance_m);
    }
    if (farthest_m < rules_.min_distance_ratio * nearest_m) {
      refuse(
          "all views are at one distance ({:.2f} to {:.2f} m); show the board nearer and farther, "
          "too",
          nearest_m, farthest_m);
    }
  }

  void judge_error() {
    const double limit_px =
        rules_.max_rms_px * std::max(1.0, calibration_.intrinsics.width_px / 640.0);
    if (calibration_.rms_px > limit_px) {
      refuse(
          "the reprojection error is too large: {:.2f} px, but at most {:.2f} px are allowed; "
          "check that the board is flat, and hold it still",
          calibration_.rms_px, limit_px);
    }
  }

  void judge_spread() {
    const geometry::CameraIntrinsics& camera = calibration_.intrinsics;
    const double fc_sd = std::max(calibration_.fc_sd_px[0] / camera.fc_px[0],
                                  calibration_.fc_sd_px[1] / camera.fc_px[1]);
    if (!(fc_sd <= rules_.max_fc_sd)) {
      refuse(
          "the focal length is uncertain by {:.1f} % (one standard deviation), but at most {:.1f} "
          "% are allowed; add views with more tilt",
          100.0 * fc_sd, 100.0 * rules_.max_fc_sd);
    }
    const double cc_sd_px = std::max(calibration_.cc_sd_px[0], calibration_.cc_sd_px[1]);
    const double limit_px = rules_.max_cc_sd * camera.width_px;
    if (!(cc_sd_px <= limit_px)) {
      refuse(
          "the principal point is uncertain by {:.1f} px (one standard deviation), but at most "
          "{:.1f} px are allowed; add views with more tilt",
          cc_sd_px, limit_px);
    }
  }

  void judge_camera() {
    const geometry::CameraIntrinsics& camera = calibration_.intrinsics;
    const double dx = (camera.cc_px[0] - 0.5 * (camera.width_px - 1)) / camera.width_px;
    const double dy = (camera.cc_px[1] - 0.5 * (camera.height_px - 1)) / camera.height_px;
    if (std::max(std::abs(dx), std::abs(dy)) > rules_.max_cc_offset) {
      refuse(
          "the principal point ({:.0f}, {:.0f}) is far from the middle of the picture; use "
          "pictures that are not cropped",
          camera.cc_px[0], camera.cc_px[1]);
    }
    const double difference = std::abs(camera.fc_px[0] / camera.fc_px[1] - 1.0);
    if (difference > rules_.max_fc_difference) {
      refuse(
          "the two focal lengths differ by {:.0f} %; check that the pictures are not stretched and "
          "the squares of the board are square",
          100.0 * difference);
    }
    // The distortion model must be invertible at the image's corners.
    for (const double u : {0.0, camera.width_px - 1.0}) {
      for (const double v : {0.0, camera.height_px - 1.0}) {
        const Eigen::Vector2d ray = camera_.undistort({u, v});
        const auto back = camera_.project({ray.x(), ray.y(), 1.0});
        if (back && (*back - Eigen::Vector2d(u, v)).norm() < 0.5) continue;
        return refuse(
            "the estimated distortion is not invertible inside the picture; show the board in the "
            "corners of the picture");
      }
    }
  }

  const CameraCalibration& calibration_;
  const CameraAcceptanceLimits& rules_;
  geometry::CameraModel camera_;
  std::vector<std::string> reasons_;
};

}  // namespace

double CameraCoverage::fraction() const {
  if (corners.empty()) return 0.0;
  const auto seen = std::count_if(corners.begin(), corners.end(), [](int n) { return n > 0; });
  return static_cast<double>(seen) / static_cast<double>(corners.size());
}

CameraCoverage coverage_of(const CameraCalibration& calibration, int columns, int rows) {
  CameraCoverage coverage{columns, rows, {}};
  coverage.corners.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
  for (const Eigen::Vector2d& corner_px : calibration.corners_px) {
    const double across = (corner_px.x() + 0.5) / calibration.intrinsics.width_px;
    const double down = (corner_px.y() + 0.5) / calibration.intrinsics.height_px;
    const int column = std::clamp(static_cast<int>(across * columns), 0, columns - 1);
    const int row = std::clamp(static_cast<int>(down * rows), 0, rows - 1);
    ++coverage.corners[static_cast<std::size_t>(row * columns + column)];
  }
  return coverage;
}

std::vector<std::string> rejection_reasons(const CameraCalibration& calibration,
                                           const CameraAcceptanceLimits& rules) {
  return Judge(calibration, rules).reasons();
}

}  // namespace orchard::calibration
