// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/camera_acceptance.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "text/number_text.hpp"

namespace orchard::calibration {
namespace {

std::string degrees(double angle_rad) { return fixed_text(angle_rad * 180.0 / geometry::kPi, 0); }

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
  void judge_views() {
    if (calibration_.num_views < rules_.min_views) {
      reasons_.push_back("too few views: " + std::to_string(calibration_.num_views) +
                         " of the board are used, but " + std::to_string(rules_.min_views) +
                         " are needed, better 20");
    }
    const auto all = static_cast<double>(calibration_.views.size());
    const double outliers = all - calibration_.num_views;
    if (outliers > rules_.max_outlier_fraction * all) {
      reasons_.push_back(
          "too many outliers: " + fixed_text(outliers, 0) + " of " + fixed_text(all, 0) +
          " views disagree with the others; check that the board is flat, and hold it still");
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
    std::string empty;
    int num_empty = 0;
    for (const auto& [cell, name] : corners) {
      if (coverage.corners[static_cast<std::size_t>(cell)] > 0) continue;
      empty += (num_empty++ > 0 ? ", " : "") + std::string(name);
    }
    if (num_empty > 0) {
      reasons_.push_back("the board was never seen in the " + empty + " corner" +
                         (num_empty > 1 ? "s" : "") +
                         " of the picture, where the lens bends most; show it there");
    }
    if (coverage.fraction() < rules_.min_coverage) {
      reasons_.push_back("only " + fixed_text(100.0 * coverage.fraction(), 0) +
                         " % of the picture was covered by the board, but " +
                         fixed_text(100.0 * rules_.min_coverage, 0) +
                         " % are needed; move the board over the whole picture");
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
      reasons_.push_back("the tilt is too small: " + std::to_string(tilted) +
                         " views are tilted by " + degrees(rules_.min_tilt_rad) +
                         " degrees or more (max " + degrees(largest_rad) + "), " +
                         std::to_string(rules_.min_tilted) +
                         " are needed; without tilt the focal length is not determined");
      return;
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
      reasons_.push_back(std::string("the board was never tilted ") +
                         (side ? "to the left and right" : "up and down") +
                         "; tilt it to all four sides");
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
      reasons_.push_back("all views are at one distance (" + fixed_text(nearest_m, 2) + " to " +
                         fixed_text(farthest_m, 2) + " m); show the board nearer and farther, too");
    }
  }

  void judge_error() {
    const double limit_px =
        rules_.max_rms_px * std::max(1.0, calibration_.intrinsics.width_px / 640.0);
    if (calibration_.rms_px > limit_px) {
      reasons_.push_back(
          "the reprojection error is too large: " + fixed_text(calibration_.rms_px, 2) +
          " px, but at most " + fixed_text(limit_px, 2) +
          " px are allowed; check that the board is flat, and hold it still");
    }
  }

  void judge_spread() {
    const geometry::CameraIntrinsics& camera = calibration_.intrinsics;
    const double fc_sd = std::max(calibration_.fc_sd_px[0] / camera.fc_px[0],
                                  calibration_.fc_sd_px[1] / camera.fc_px[1]);
    if (!(fc_sd <= rules_.max_fc_sd)) {
      reasons_.push_back("the focal length is uncertain by " + fixed_text(100.0 * fc_sd, 1) +
                         " % (one standard deviation), but at most " +
                         fixed_text(100.0 * rules_.max_fc_sd, 1) +
                         " % are allowed; add views with more tilt");
    }
    const double cc_sd_px = std::max(calibration_.cc_sd_px[0], calibration_.cc_sd_px[1]);
    const double limit_px = rules_.max_cc_sd * camera.width_px;
    if (!(cc_sd_px <= limit_px)) {
      reasons_.push_back("the principal point is uncertain by " + fixed_text(cc_sd_px, 1) +
                         " px (one standard deviation), but at most " + fixed_text(limit_px, 1) +
                         " px are allowed; add views with more tilt");
    }
  }

  void judge_camera() {
    const geometry::CameraIntrinsics& camera = calibration_.intrinsics;
    const double dx = (camera.cc_px[0] - 0.5 * (camera.width_px - 1)) / camera.width_px;
    const double dy = (camera.cc_px[1] - 0.5 * (camera.height_px - 1)) / camera.height_px;
    if (std::max(std::abs(dx), std::abs(dy)) > rules_.max_cc_offset) {
      reasons_.push_back(
          "the principal point (" + fixed_text(camera.cc_px[0], 0) + ", " +
          fixed_text(camera.cc_px[1], 0) +
          ") is far from the middle of the picture; use pictures that are not cropped");
    }
    const double ratio = camera.fc_px[0] / camera.fc_px[1];
    if (std::abs(ratio - 1.0) > rules_.max_fc_difference) {
      reasons_.push_back(
          "the two focal lengths differ by " + fixed_text(100.0 * std::abs(ratio - 1.0), 0) +
          " %; check that the pictures are not stretched and the squares of the board are square");
    }
    // The distortion model must be invertible at the image's corners.
    for (const double u : {0.0, camera.width_px - 1.0}) {
      for (const double v : {0.0, camera.height_px - 1.0}) {
        const Eigen::Vector2d ray = camera_.undistort({u, v});
        const auto back = camera_.project({ray.x(), ray.y(), 1.0});
        if (back && (*back - Eigen::Vector2d(u, v)).norm() < 0.5) continue;
        reasons_.push_back(
            "the estimated distortion is not invertible inside the picture; show the board in the "
            "corners of the picture");
        return;
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
  for (const CornerResidual& corner : calibration.residuals) {
    const double across = (corner.found_px.x_px + 0.5) / calibration.intrinsics.width_px;
    const double down = (corner.found_px.y_px + 0.5) / calibration.intrinsics.height_px;
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
