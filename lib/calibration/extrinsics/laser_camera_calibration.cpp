// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/extrinsics/laser_camera_calibration.hpp"

#include <fmt/core.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/board/board_association.hpp"
#include "geometry/angles.hpp"
#include "text/number_text.hpp"

namespace orchard::calibration {
namespace {

using ViewStatus = LaserCameraView::ViewStatus;

/// Half width of the 95 % interval of Student's t in standard deviations, by the Cornish-Fisher
/// expansion; accurate to 1 % from 3 degrees of freedom on.
double student_95(double degrees_of_freedom) {
  const double f = std::max(3.0, degrees_of_freedom);
  const double z = 1.959964;
  const double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4.0 * f) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * f * f) +
         (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * f * f * f);
}

/// derived: max number of times that the lines are chosen again with the board's size found. Each
/// time the error of the size shrinks by more than half, so four are enough for 1 % of 20 %.
constexpr int kSizeRounds = 4;

class Calibration {
 public:
  Calibration(const std::vector<ExtrinsicsView>& views, const BoardOutline& outline,
              const LaserCameraOptions& options)
      : views_(views), outline_(outline), options_(options) {
    out_.views.resize(views.size());
  }

  LaserCameraCalibration run() {
    out_.refusal = why_not();
    return out_;
  }

 private:
  std::string why_not() {
    if (static_cast<int>(views_.size()) < options_.min_views) {
      return "only " + std::to_string(views_.size()) + " views of the board, but at least " +
             std::to_string(options_.min_views) + " are needed; hold it still in more places";
    }
    std::vector<BoardPose> boards;
    int num_with_line = 0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      boards.push_back(views_[i].board);
      if (!views_[i].lines.empty()) {
        ++num_with_line;
        out_.views[i].status = ViewStatus::kNotSeen;
      }
    }
    if (num_with_line < options_.min_views) {
      return "the scanner found no line as long as the board in " +
             std::to_string(views_.size() - static_cast<std::size_t>(num_with_line)) + " of " +
             std::to_string(views_.size()) +
             " views with a board in the picture; hold the board where the scan plane cuts it";
    }
    const std::string degenerate = degenerate_motion(board_motion(boards));
    if (!degenerate.empty()) return degenerate;

    Association association = associate_board_lines(views_, outline_);
    const int wanted =
        std::max(options_.min_views,
                 static_cast<int>(std::ceil(options_.min_fitting_fraction * num_with_line)));
    if (association.num_fitting < wanted && find_board_scale(views_, outline_, association)) {
      return wrong_size();
    }
    if (association.num_fitting < wanted) {
      return "no pose of the scanner puts its lines on the board in more than " +
             std::to_string(association.num_fitting) + " of " + std::to_string(num_with_line) +
             " views (" + std::to_string(wanted) +
             " are needed): check that the scan plane cuts the board, the size of the board, the "
             "intrinsics of the camera, and the times of scans and pictures";
    }
    // Five views fit some mount by chance: a rival needs at least six views and 90 % of the best.
    if (association.rival_fitting >= std::max(6, (9 * association.num_fitting + 9) / 10)) {
      if (find_board_scale(views_, outline_, association)) return wrong_size();
      return "two different poses of the scanner explain the views equally well (" +
             std::to_string(association.num_fitting) + " and " +
             std::to_string(association.rival_fitting) +
             " views): tilt the board more and to all sides";
    }
    return adjust(association);
  }

  /// The views as they would be if the board were `size` times as large as stated.
  static std::vector<ExtrinsicsView> resized(std::vector<ExtrinsicsView> views, double size) {
    for (ExtrinsicsView& view : views) {
      view.board.t_camera_board_m *= size;
      view.board.covariance.bottomRows<3>() *= size;
      view.board.covariance.rightCols<3>() *= size;
    }
    return views;
  }

  /// The outline on a board whose squares are `size` times as large as stated. Its centre moves
  /// with the squares; its sides do so unless they were measured themselves.
  BoardOutline resized(const BoardOutline& outline, double size) const {
    const double sides = options_.use_edges ? 1.0 : size;
    const double x_m = size * 0.5 * (outline.x_min_m + outline.x_max_m);
    const double y_m = size * 0.5 * (outline.y_min_m + outline.y_max_m);
    const double half_x_m = sides * 0.5 * (outline.x_max_m - outline.x_min_m);
    const double half_y_m = sides * 0.5 * (outline.y_max_m - outline.y_min_m);
    return {x_m - half_x_m, y_m - half_y_m, x_m + half_x_m, y_m + half_y_m};
  }

  /// Adjusts mount and board size, leaving out the views that disagree most until all agree. None
  /// if too many would have to be left out.
  std::optional<ExtrinsicsAdjustment> adjust_size(const std::vector<ExtrinsicsView>& views,
                                                  const Association& association) const {
    std::vector<AdjustmentView> chosen;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (association.line_of_view[i] < 0) continue;
      const auto line = static_cast<std::size_t>(association.line_of_view[i]);
      chosen.push_back({views[i].board, views[i].lines[line], views[i].num_scans});
    }
    const auto num_first = static_cast<double>(chosen.size());
    RangeNoise any_size = options_.noise;
    any_size.scale_sd_fraction = 0.5;
    for (;;) {
      const double left_out = num_first - static_cast<double>(chosen.size());
      if (static_cast<int>(chosen.size()) < options_.min_views ||
          left_out > options_.outlier_fraction_max * num_first) {
        return std::nullopt;
      }
      auto adjusted = adjust_extrinsics(chosen, association.mount, any_size, nullptr);
      if (!adjusted || !(adjusted->scale < 0.5)) return std::nullopt;
      const auto worst = std::max_element(
          adjusted->views.begin(), adjusted->views.end(),
          [](const auto& a, const auto& b) { return a.disagreement < b.disagreement; });
      if (worst->disagreement <= options_.disagreement_max) return adjusted;
      chosen.erase(chosen.begin() + (worst - adjusted->views.begin()));
    }
  }

  /// Estimates the true over stated size of the board from the ranges: distances from the images
  /// are proportional to the stated size, those of the scanner are not. Sets board_scale and
  /// returns true if the size differs.
  bool find_board_scale(const std::vector<ExtrinsicsView>& views, const BoardOutline& outline,
                        const Association& stated) {
    // derived: steps of 5 %, which refinement bridges; the nearest to the stated size first.
    // If no mount fits the stated size, start from one that fits another size.
    constexpr std::array<double, 11> kSizes{1.0, 0.9,  1.1,  0.85, 1.15, 0.8,
                                            1.2, 0.75, 1.25, 0.95, 1.05};
    const int enough = std::max(options_.min_views, static_cast<int>(views.size()) * 2 / 3);
    double size = 1.0;
    Association association = stated;
    for (const double other_size : kSizes) {
      if (association.num_fitting >= enough) break;
      if (other_size == 1.0) continue;
      Association other =
          associate_board_lines(resized(views, other_size), resized(outline, other_size));
      if (other.num_fitting <= association.num_fitting) continue;
      association = std::move(other);
      size = other_size;
    }
    // A board taken for too large or too small has lines of other things beside it taken for its
    // own. So the lines are chosen again with the size found, until it stays.
    double sd = 0.0;
    for (int round = 0; round < kSizeRounds; ++round) {
      const auto adjusted = adjust_size(resized(views, size), association);
      if (!adjusted) return false;
      // Ranges that seem too long by a fraction mean that the board is larger by that fraction.
      const double change = 1.0 / (1.0 - adjusted->scale);
      size *= change;
      sd = size * std::hypot(adjusted->scale_sd, options_.noise.scale_sd_fraction);
      if (std::abs(change - 1.0) < adjusted->scale_sd) break;
      association = associate_board_lines(resized(views, size), resized(outline, size));
    }
    // derived: 3 sigma.
    constexpr double kSure = 3.0;
    if (std::abs(size - 1.0) < std::max(options_.board_scale_max, kSure * sd)) return false;
    out_.board_scale = size;
    out_.board_scale_sd = sd;
    return true;
  }

  std::string wrong_size() const {
    return "according to the ranges the board has " + fixed_text(100.0 * out_.board_scale, 1) +
           " % of its stated size (standard deviation " +
           fixed_text(100.0 * out_.board_scale_sd, 1) + " %)";
  }

  std::string adjust(const Association& association) {
    std::vector<std::size_t> used;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (association.line_of_view[i] < 0) continue;
      out_.views[i].line = association.line_of_view[i];
      used.push_back(i);
    }
    const std::size_t num_first = used.size();
    std::optional<ExtrinsicsAdjustment> adjustment;
    for (;;) {
      std::vector<AdjustmentView> chosen;
      for (const std::size_t i : used) {
        const auto line = static_cast<std::size_t>(out_.views[i].line);
        chosen.push_back({views_[i].board, views_[i].lines[line], views_[i].num_scans});
      }
      adjustment = adjust_extrinsics(chosen, association.mount, options_.noise,
                                     options_.use_edges ? &outline_ : nullptr);
      if (!adjustment) return "the extrinsics could not be estimated; record again";
      std::size_t worst = 0;
      for (std::size_t k = 0; k < used.size(); ++k) {
        auto& view = out_.views[used[k]];
        view.status = ViewStatus::kUsed;
        view.rms_m = adjustment->views[k].rms_m;
        view.mean_m = adjustment->views[k].mean_m;
        view.disagreement = adjustment->views[k].disagreement;
        if (view.disagreement > out_.views[used[worst]].disagreement) worst = k;
      }
      if (out_.views[used[worst]].disagreement <= options_.disagreement_max) break;
      out_.views[used[worst]].status = ViewStatus::kOutlier;
      used.erase(used.begin() + static_cast<std::ptrdiff_t>(worst));
      const double left_out = static_cast<double>(num_first - used.size());
      if (left_out > options_.outlier_fraction_max * static_cast<double>(num_first) ||
          static_cast<int>(used.size()) < options_.min_views) {
        if (find_board_scale(views_, outline_, association)) return wrong_size();
        return "the views contradict each other: " + std::to_string(num_first - used.size()) +
               " of " + std::to_string(num_first) +
               " are outliers; hold the board still, and check its square size and the camera's "
               "intrinsics";
      }
    }
    Association kept = association;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (out_.views[i].status != ViewStatus::kUsed) kept.line_of_view[i] = -1;
    }
    kept.num_fitting = static_cast<int>(views_.size());
    if (find_board_scale(views_, outline_, kept)) return wrong_size();
    out_.num_used = static_cast<int>(used.size());
    out_.mount = adjustment->mount;
    out_.rms_m = adjustment->rms_m;
    out_.covariance = adjustment->covariance;
    out_.interval95_factor = student_95(adjustment->scan_redundancy);
    for (int i = 0; i < 3; ++i) {
      out_.extrinsics.delta_m[static_cast<std::size_t>(i)] = out_.mount.delta_m[i];
    }
    out_.extrinsics.phi_rad = geometry::paper_angles_rad(out_.mount.R_camera_laser);
    std::vector<BoardPose> boards;
    for (const std::size_t i : used) boards.push_back(views_[i].board);
    const BoardMotion motion = board_motion(boards);
    const std::string degenerate = degenerate_motion(motion);
    if (!degenerate.empty()) return degenerate;
    return undetermined_direction(out_.covariance, options_.shift_sd_max_m,
                                  options_.turn_sd_max_rad, motion);
  }

  const std::vector<ExtrinsicsView>& views_;
  const BoardOutline& outline_;
  const LaserCameraOptions& options_;
  LaserCameraCalibration out_;
};

}  // namespace

LaserCameraOptions laser_camera_options(const laser::LaserConfig& laser) {
  LaserCameraOptions options;
  options.noise.beam_sd_m = std::max(1e-4, laser.range_sd_m);
  options.noise.beam_sd_fraction = laser.range_sd_fraction;
  options.noise.scan_sd_fraction = std::max(1e-3, laser.range_sd_fraction);
  return options;
}

BoardLineSearch line_search(const BoardOutline& outline, const laser::LaserConfig& laser) {
  const double width_m = outline.x_max_m - outline.x_min_m;
  const double height_m = outline.y_max_m - outline.y_min_m;
  BoardLineSearch search;
  search.length_min_m = 0.45 * std::min(width_m, height_m);
  search.length_max_m = 1.03 * std::hypot(width_m, height_m) + 0.02;
  search.range_sd_m = std::max(1e-3, laser.range_sd_m);
  search.range_sd_fraction = laser.range_sd_fraction;
  return search;
}

LaserCameraCalibration calibrate_laser_camera(const std::vector<ExtrinsicsView>& views,
                                              const BoardOutline& outline,
                                              const LaserCameraOptions& options) {
  return Calibration(views, outline, options).run();
}

namespace {

// derived: half of the 90 degrees between two ways to mount a camera.
constexpr double kLargest_deg = 45.0;
constexpr double kOtherSide_m = 0.05;

double angle_deg(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle() * 180.0 / geometry::kPi;
}

/// The extrinsics that a calibration finds for a mirrored image: the two directions of the scan
/// plane are mirrored, and the third completes the rotation.
RigidExtrinsics mirrored(const RigidExtrinsics& mount, const Eigen::Vector3d& mirror) {
  RigidExtrinsics seen;
  seen.R_camera_laser = mirror.asDiagonal() * mount.R_camera_laser;
  seen.R_camera_laser.col(2) *= -1.0;
  seen.delta_m = mirror.asDiagonal() * mount.delta_m;
  return seen;
}

}  // namespace

std::string extrinsics_contradiction(const RigidExtrinsics& found, const RigidExtrinsics& stated) {
  const double turned_deg = angle_deg(found.R_camera_laser, stated.R_camera_laser);
  if (turned_deg > kLargest_deg) {
    const RigidExtrinsics left_right = mirrored(stated, {-1.0, 1.0, 1.0});
    if (angle_deg(found.R_camera_laser, left_right.R_camera_laser) < 0.5 * kLargest_deg) {
      return "the pictures are mirrored left to right, or the camera is mounted upside down, in "
             "contrast to camera.phi_rad (a scanner with one plane cannot distinguish them)";
    }
    return fmt::format("the camera is rotated by {:.0f} deg relative to camera.phi_rad",
                       turned_deg);
  }
  const RigidExtrinsics top_bottom = mirrored(stated, {1.0, -1.0, 1.0});
  const double off_m = (found.delta_m - stated.delta_m).norm();
  if (off_m > kOtherSide_m && (found.delta_m - top_bottom.delta_m).norm() < 0.3 * off_m) {
    return "the pictures are mirrored top to bottom, or the laser is on the other side of the "
           "camera than camera.delta_m states (a scanner with one plane cannot distinguish them)";
  }
  return {};
}

}  // namespace orchard::calibration
