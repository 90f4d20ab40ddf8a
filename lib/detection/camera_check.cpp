// SPDX-License-Identifier: BSD-3-Clause
#include "detection/camera_check.hpp"

#include <fmt/core.h>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "detection/trunk_view.hpp"
#include "geometry/angles.hpp"
#include "timing/units.hpp"
#include "vision/edges.hpp"

namespace orchard::detection {
namespace {

/// derived: bands so low that an upright line is upright in each, tilted as a trunk may be; from a
/// quarter to three quarters of the picture, where trunks are.
constexpr int kBands = 6;
/// derived: for the numeric derivative of a column.
constexpr double kRateStep_s = 0.002;

// derived: the cameras to ask about. Steps of a column, so that no camera falls between two; focal
// lengths from a third to three times; delays as the key allows.
constexpr int kFocalSteps = 26;         // to either side
constexpr double kFocalRatio = 1.0433;  // 1.0433^26 = 3
constexpr double kShiftMax_deg = 15.0;
constexpr int kShiftStep_px = 1;
constexpr double kDelayMax_s = 0.4;
constexpr double kDelayStep_s = 0.02;
constexpr double kTiltMax_deg = 12.0;
constexpr double kTiltCoarse_deg = 2.4;
constexpr double kTiltFine_deg = 0.8;

/// derived: 1 in two million: another camera must be this much more probable than the rig's own;
/// some thousands are asked.
constexpr double kBetter_sigma = 5.0;
constexpr std::size_t kSidesMin = 40;
/// derived: time between two pictures [s], and pictures of a window: enough to tell a degree; more
/// only cost. The first answer comes after a quarter of it.
constexpr double kPeriod_s = 1.0;
constexpr std::size_t kWindow = 60;
/// derived: with these the right camera stands out by tens of standard deviations; more only cost.
constexpr std::size_t kSidesMax = 300;
// physical: a camera calibrated once is within these; beyond them trunks are taken for others'.
constexpr double kYawTolerance_deg = 1.5;
constexpr double kTiltTolerance_deg = 3.0;
/// derived: leaning lines met at another height than the scan's are shifted by up to this.
constexpr double kTiltShift_deg = 2.5;
constexpr double kFocalTolerance = 0.15;
constexpr double kDelayTolerance_s = 0.075;

double radians(double angle_deg) { return angle_deg * geometry::kPi / 180.0; }

/// Share of edge pixels per column in some rows of an edge map.
std::vector<float> profile_of(const vision::EdgeMap& map, int first_row, int num_rows) {
  const int width = map.area.width_px;
  std::vector<float> share(static_cast<std::size_t>(width), 0.0F);
  for (int row = first_row; row < first_row + num_rows; ++row) {
    const std::uint8_t* edges = map.edges.data() + static_cast<std::ptrdiff_t>(row) * width;
    for (int x = 0; x < width; ++x)
      share[static_cast<std::size_t>(x)] += edges[x] != 0 ? 1.0F : 0.0F;
  }
  // An edge is a pixel wide, and the sides are known to a pixel: neighbours count half.
  std::vector<float> soft = share;
  for (std::size_t x = 1; x + 1 < share.size(); ++x) {
    soft[x] = share[x] + 0.5F * (share[x - 1] + share[x + 1]);
  }
  float mean = 0.0F, square = 0.0F;
  for (const float s : soft) mean += s;
  mean /= static_cast<float>(width);
  for (float& s : soft) {
    s -= mean;
    square += s * s;
  }
  const float spread = std::sqrt(square / static_cast<float>(width));
  for (float& s : soft) s = spread > 0.0F ? s / spread : 0.0F;
  return soft;
}

/// Adds the profile's values at a column moved by -n to n steps to the 2 n + 1 sums.
void add_shifted(const std::vector<float>& profile, double column_px, int step_px,
                 std::vector<double>& sums) {
  const double middle = std::floor(column_px + 0.5);
  if (!(std::abs(middle) < 1e6)) return;
  const int width = static_cast<int>(profile.size());
  int x = static_cast<int>(middle) - step_px * static_cast<int>(sums.size() / 2);
  for (double& sum : sums) {
    if (x >= 0 && x < width) sum += static_cast<double>(profile[static_cast<std::size_t>(x)]);
    x += step_px;
  }
}

/// Columns per row of an upright line at a pixel, by the rig.
double slope_at(const Eigen::Vector2d& pixel, const Rig& rig) {
  const Eigen::Vector3d up = rig.T_camera_laser.rotation().col(2);
  const auto& fc_px = rig.camera.intrinsics().fc_px;
  const Eigen::Vector2d n = rig.camera.undistort(pixel);
  const double down = up.y() - n.y() * up.z();
  return std::abs(down) < 1e-3 ? 0.0 : fc_px[0] / fc_px[1] * (up.x() - n.x() * up.z()) / down;
}

void add_once(const Finding& finding, std::vector<Finding>& findings) {
  const bool is_known = std::any_of(findings.begin(), findings.end(),
                                    [&](const Finding& f) { return f.name == finding.name; });
  if (!is_known) findings.push_back(finding);
}

/// The middle half of the picture, in bands of equal height; empty if it is too low for them.
vision::PixelRect bands_area(const Rig& rig) {
  const vision::PixelRect whole = picture_of(rig);
  return {0, whole.height_px / 4, whole.width_px, kBands * (whole.height_px / (2 * kBands))};
}

}  // namespace

std::optional<CameraSight> camera_sight(const LaserFindings& findings,
                                        vision::PictureReader& picture, const Rig& rig,
                                        const std::optional<Motion>& motion) {
  const vision::Image& image = picture.image();
  const vision::PixelRect whole = picture_of(rig);
  if (image.width_px != whole.width_px || image.height_px != whole.height_px) return std::nullopt;
  const ScanToPicture to_exposure = to_picture(findings, image, rig, motion);
  CameraSight sight;
  for (const Candidate& candidate : findings.candidates) {
    const auto seen = sides_of(candidate.segment, rig, to_exposure);
    if (!seen) continue;
    const auto view = view_of(candidate.segment, rig, to_exposure);
    if (view) picture.expect(reading_area(*view, rig));
    double rate_px_per_s = 0.0;
    if (to_exposure.motion) {
      ScanToPicture later = to_exposure;
      later.first_beam_dt_s += kRateStep_s;
      const auto moved = sides_of(candidate.segment, rig, later);
      if (!moved) continue;
      rate_px_per_s = 0.5 *
                      (moved->left_x_px + moved->right_x_px - seen->left_x_px - seen->right_x_px) /
                      kRateStep_s;
    }
    for (const double column_px : {seen->left_x_px, seen->right_x_px}) {
      sight.sides.push_back(
          {column_px, seen->row_px, slope_at({column_px, seen->row_px}, rig), rate_px_per_s});
    }
  }
  if (sight.sides.empty()) return std::nullopt;
  const vision::PixelRect middle = bands_area(rig);
  const int band_rows = middle.height_px / kBands;
  if (band_rows < 1) return std::nullopt;
  const auto pixels = picture.read(vision::edge_reading_area(middle, whole));
  if (!pixels) return std::nullopt;
  const vision::EdgeMap map = vision::edge_map(*pixels, middle, rig.detector.edges);
  for (int band = 0; band < kBands; ++band) {
    sight.bands.push_back(profile_of(map, band * band_rows, band_rows));
    sight.band_row_px.push_back(middle.y_px + (band + 0.5) * band_rows);
  }
  sight.all_bands.assign(static_cast<std::size_t>(whole.width_px), 0.0F);
  for (const std::vector<float>& band : sight.bands) {
    for (std::size_t x = 0; x < band.size(); ++x) sight.all_bands[x] += band[x];
  }
  return sight;
}

/// A camera relative to the rig's own.
struct CameraCheck::Camera {
  double zoom = 1.0;  ///< factor of the focal length; negative: flipped
  double shift_px = 0.0;
  double later_s = 0.0;  ///< exposure after that of the rig
};

struct CameraCheck::Fit {
  Camera camera;
  double score = -1e9;
};

/// How upright lines lie beside what the rig says.
struct CameraCheck::Tilt {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
};

/// Standard deviations by which the edges at the expected columns are more than by chance, for each
/// shift by -`num_shifts` to `num_shifts` steps. Without a tilt all bands are taken together.
std::vector<double> CameraCheck::scores(const Camera& camera, const std::optional<Tilt>& tilt,
                                        int num_shifts, int step_px) const {
  const auto& intrinsics = rig_.camera.intrinsics();
  const double centre_px = intrinsics.cc_px[0], focal_px = intrinsics.fc_px[0];
  std::vector<double> sums(2 * static_cast<std::size_t>(num_shifts) + 1, 0.0);
  std::size_t num = 0;
  for (std::size_t i = 0; i < sights_.size(); i += stride()) {
    const CameraSight& sight = sights_[i];
    num += sight.sides.size();
    for (const CameraSight::Side& side : sight.sides) {
      const double away_px =
          camera.zoom * (side.column_px + camera.later_s * side.rate_px_per_s - centre_px);
      if (!tilt) {
        add_shifted(sight.all_bands, centre_px + away_px, step_px, sums);
        continue;
      }
      const double slope = side.slope + tilt->roll_rad + tilt->pitch_rad * away_px / focal_px;
      for (std::size_t band = 0; band < sight.bands.size(); ++band) {
        const double lower_px = sight.band_row_px[band] - side.row_px;
        add_shifted(sight.bands[band], centre_px + away_px + slope * lower_px, step_px, sums);
      }
    }
  }
  // An edge that crosses all bands is one edge: the bands count as one.
  for (double& sum : sums) sum /= kBands * std::sqrt(static_cast<double>(num));
  return sums;
}

/// The step between the pictures that are used: a part of many is enough.
std::size_t CameraCheck::stride() const { return num_sides_ / kSidesMax + 1; }

bool LookTimes::take(std::int64_t utime) {
  if (last_utime_ && timing::seconds(utime - *last_utime_) < kPeriod_s) return false;
  last_utime_ = utime;
  return true;
}

void CameraCheck::add(CameraSight sight) {
  num_sides_ += sight.sides.size();
  sights_.push_back(std::move(sight));
  ++num_added_;
  if (sights_.size() > kWindow) {
    num_sides_ -= sights_.front().sides.size();
    sights_.pop_front();
  }
  if (num_added_ == kWindow / 4 || num_added_ == kWindow / 2 || num_added_ % kWindow == 0) judge();
}

void CameraCheck::finish() {
  if (num_judged_ < num_added_) judge();
  for (const Finding& finding : findings_) add_once(finding, of_run_);
  findings_ = of_run_;
}

/// The best camera of those that are zoomed, delayed and shifted by at most so many steps.
CameraCheck::Fit CameraCheck::best_of(double sign, int num_zooms, int num_delays,
                                      int num_shifts) const {
  Fit best;
  for (int f = -num_zooms; f <= num_zooms; ++f) {
    for (int d = -num_delays; d <= num_delays; ++d) {
      Camera camera{sign * std::pow(kFocalRatio, f), 0.0, d * kDelayStep_s};
      const std::vector<double> fits = scores(camera, std::nullopt, num_shifts, kShiftStep_px);
      const auto best_shift = std::max_element(fits.begin(), fits.end());
      if (*best_shift <= best.score) continue;
      camera.shift_px = kShiftStep_px * static_cast<double>(best_shift - fits.begin() - num_shifts);
      best = {camera, *best_shift};
    }
  }
  return best;
}

void CameraCheck::judge() {
  // What a full window said stays true of the run; a short one may yet think better of it.
  if (num_judged_ >= kWindow) {
    for (const Finding& finding : findings_) add_once(finding, of_run_);
  }
  findings_.clear();
  num_judged_ = num_added_;
  if (num_sides_ < kSidesMin) return;
  const double focal_px = rig_.camera.intrinsics().fc_px[0];
  const auto steps = [focal_px](double angle_deg) {
    return static_cast<int>(focal_px * std::tan(radians(angle_deg)) / kShiftStep_px);
  };
  const int num_small = steps(kYawTolerance_deg), num_shifts = steps(kShiftMax_deg);
  const int num_delays =
      rig_.detector.use_odometry ? static_cast<int>(kDelayMax_s / kDelayStep_s) : 0;
  // One fault is more probable than two: each is asked about by itself.
  const Fit own = best_of(1.0, 0, 0, num_small);
  Fit best = own;
  for (const Fit& other :
       {best_of(1.0, 0, 0, num_shifts), best_of(1.0, 0, num_delays, num_small),
        best_of(1.0, kFocalSteps, 0, num_small), best_of(-1.0, 0, 0, num_shifts)}) {
    if (other.score > best.score) best = other;
  }
  if (best.score > own.score + kBetter_sigma) name(best.camera);
  if (findings_.empty()) judge_tilt();
}

void CameraCheck::name(const Camera& best) {
  const double focal_px = rig_.camera.intrinsics().fc_px[0];
  const std::string by = fmt::format(" (edges of {} pictures against the scans)", sights_.size());
  const double yaw_deg = std::atan(best.shift_px / focal_px) * 180.0 / geometry::kPi;
  if (best.zoom < 0.0) {
    findings_.push_back({"camera_flipped", "camera.phi_rad",
                         "the pictures are the wrong way round: the camera is mounted upside down, "
                         "or they are mirrored; turn the pictures in the camera driver, or "
                         "calibrate camera.phi_rad anew (orchard calibrate laser-camera)" +
                             by});
  } else if (std::abs(best.zoom - 1.0) > kFocalTolerance) {
    findings_.push_back(
        {"camera_focal", "camera.fc_px",
         fmt::format("camera.fc_px is {:.0f}, but the pictures fit {:.0f}: it belongs to another "
                     "lens or another size of picture (orchard calibrate camera)",
                     focal_px, best.zoom * focal_px) +
             by});
  } else if (std::abs(best.later_s) > kDelayTolerance_s) {
    findings_.push_back({"camera_delay", "camera.delay_s",
                         fmt::format("camera.delay_s is {:.2f}, but the pictures fit {:.2f} "
                                     "(orchard calibrate delay)",
                                     rig_.camera_delay_s, rig_.camera_delay_s - best.later_s) +
                             by});
  } else if (std::abs(yaw_deg) > kYawTolerance_deg) {
    findings_.push_back({"camera_yaw", "camera.phi_rad",
                         fmt::format("the pictures lie {:.1f} degrees to the {} of where "
                                     "camera.phi_rad puts them (orchard calibrate laser-camera)",
                                     std::abs(yaw_deg), yaw_deg > 0.0 ? "right" : "left") +
                             by});
  }
}

void CameraCheck::judge_tilt() {
  const double shift_max_px = rig_.camera.intrinsics().fc_px[0] * std::tan(radians(kTiltShift_deg));
  const int num_shifts = static_cast<int>(shift_max_px / kShiftStep_px);
  // Leaning lines met at one height are shifted: the best shift goes with each tilt.
  const auto best_shifted = [&](const Tilt& tilt) {
    const std::vector<double> fits = scores({}, tilt, num_shifts / 2, 2 * kShiftStep_px);
    return *std::max_element(fits.begin(), fits.end());
  };
  Tilt best;
  double best_score = best_shifted(best);
  const auto search = [&](double step_deg, int num) {
    const Tilt start = best;
    for (int r = -num; r <= num; ++r) {
      for (int p = -num; p <= num; ++p) {
        const Tilt tilt{start.roll_rad + radians(r * step_deg),
                        start.pitch_rad + radians(p * step_deg)};
        const double fit = best_shifted(tilt);
        if (fit <= best_score) continue;
        best_score = fit;
        best = tilt;
      }
    }
  };
  search(kTiltCoarse_deg, static_cast<int>(kTiltMax_deg / kTiltCoarse_deg));
  search(kTiltFine_deg, static_cast<int>(kTiltCoarse_deg / kTiltFine_deg) - 1);
  const double roll_deg = best.roll_rad * 180.0 / geometry::kPi;
  const double pitch_deg = best.pitch_rad * 180.0 / geometry::kPi;
  const std::string by = fmt::format(" (edges of {} pictures)", sights_.size());
  if (std::abs(roll_deg) > kTiltTolerance_deg &&
      best_score > best_shifted({0.0, best.pitch_rad}) + kBetter_sigma) {
    findings_.push_back(
        {"camera_roll", "camera.phi_rad",
         fmt::format("upright edges lean by {:.0f} degrees more than camera.phi_rad "
                     "says: the camera is rolled (orchard calibrate laser-camera)",
                     std::abs(roll_deg)) +
             by});
  }
  if (std::abs(pitch_deg) > kTiltTolerance_deg &&
      best_score > best_shifted({best.roll_rad, 0.0}) + kBetter_sigma) {
    findings_.push_back(
        {"camera_pitch", "camera.phi_rad",
         fmt::format("upright edges converge as of a camera that looks {:.0f} degrees further {} "
                     "than camera.phi_rad says (orchard calibrate laser-camera)",
                     std::abs(pitch_deg), pitch_deg > 0.0 ? "up" : "down") +
             by});
  }
}

}  // namespace orchard::detection
