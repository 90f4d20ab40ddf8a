// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/extrinsics/camera_delay.hpp"

#include "calibration/tuning.hpp"

#include <fmt/core.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "detection/trunk_view.hpp"
#include "vision/decode.hpp"
#include "vision/edges.hpp"

namespace orchard::calibration {
namespace {

// derived: delays of cameras (0.3 s) and wrong extrinsics (12 px), in steps below the vote's width.
constexpr double kRateStep_s = 0.002;  ///< for the numeric derivative of the column
constexpr double kSearch_s = 0.3;      ///< search range on either side of the present delay
constexpr double kSearchStep_s = 0.005;
constexpr double kSearchOffset_px = 12.0;
constexpr double kSearchOffsetStep_px = 0.5;

struct Line {
  double delay_s = 0.0;
  double offset_px = 0.0;

  double residual(double offset_px_seen, double rate) const {
    return offset_px_seen - (offset_px - rate * delay_s);
  }
};

double least_residual(const DelayObservation& observation, const Line& line) {
  double least = line.residual(observation.offsets_px.front(), observation.rate_px_per_s);
  for (const double offset_px : observation.offsets_px) {
    const double r = line.residual(offset_px, observation.rate_px_per_s);
    if (std::abs(r) < std::abs(least)) least = r;
  }
  return least;
}

Line most_agreed(const std::vector<DelayObservation>& observations) {
  Line best;
  double best_votes = -1.0;
  const int num_delays = static_cast<int>(std::lround(kSearch_s / kSearchStep_s));
  const int num_offsets = static_cast<int>(std::lround(kSearchOffset_px / kSearchOffsetStep_px));
  for (int i = -num_delays; i <= num_delays; ++i) {
    for (int k = -num_offsets; k <= num_offsets; ++k) {
      const Line line{i * kSearchStep_s, k * kSearchOffsetStep_px};
      double votes = 0.0;
      for (const DelayObservation& observation : observations) {
        const double u = least_residual(observation, line) / tuning::kVoteWidth_px;
        if (std::abs(u) < 1.0) votes += (1.0 - u * u) * (1.0 - u * u);
      }
      if (votes > best_votes) {
        best_votes = votes;
        best = line;
      }
    }
  }
  return best;
}

double tukey_weight(double residual_px) {
  const double u = residual_px / tuning::kTukey_px;
  return std::abs(u) < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
}

struct Fit {
  Line line;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of (delay, offset)
};

/// Iteratively reweighted least squares; none if the rates do not separate delay and offset.
std::optional<Fit> refine(const std::vector<DelayObservation>& observations, Line line) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  for (int round = 0; round < 30; ++round) {
    normal.setZero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const DelayObservation& observation : observations) {
      const double r = least_residual(observation, line);
      const Eigen::Vector2d row(-observation.rate_px_per_s, 1.0);
      normal += tukey_weight(r) * row * row.transpose();
      right += tukey_weight(r) * r * row;
    }
    if (std::abs(normal.determinant()) < 1e-9) return std::nullopt;
    const Eigen::Vector2d step = normal.inverse() * right;
    line.delay_s += step(0);
    line.offset_px += step(1);
    if (std::abs(step(0)) < 1e-7 && std::abs(step(1)) < 1e-5) break;
  }
  // Errors of the observations in one image are correlated, so sum the scores per image.
  std::map<std::int32_t, Eigen::Vector2d> scores;
  for (const DelayObservation& observation : observations) {
    const double r = least_residual(observation, line);
    const auto at = scores.try_emplace(observation.picture, Eigen::Vector2d::Zero()).first;
    at->second += tukey_weight(r) * r * Eigen::Vector2d(-observation.rate_px_per_s, 1.0);
  }
  Eigen::Matrix2d meat = Eigen::Matrix2d::Zero();
  for (const auto& [picture, score] : scores) meat += score * score.transpose();
  const Eigen::Matrix2d inverse = normal.inverse();
  return Fit{line, inverse * meat * inverse};
}

void require_observations(const std::vector<DelayObservation>& observations,
                          const DelayOptions& options) {
  const int num = static_cast<int>(observations.size());
  if (num < options.min_observations) {
    throw std::runtime_error(
        fmt::format("only {} observations of trunks with both edges in the picture ({} are needed, "
                    "at up to {:.0f} m); drive past trunks with the camera looking at them",
                    num, options.min_observations, 5.0));
  }
  const auto num_turning = static_cast<int>(std::count_if(
      observations.begin(), observations.end(), [&](const DelayObservation& observation) {
        return std::abs(observation.yaw_rate_radps) >= options.turning_radps;
      }));
  if (num_turning < options.min_turning_observations) {
    throw std::runtime_error(fmt::format(
        "the robot hardly turned, so the delay is not determined: only {} of {} observations at a "
        "yaw rate of {:.1f} rad/s or more; drive in curves to both sides past trunks",
        num_turning, num, options.turning_radps));
  }
}

/// derived: lines nearer to each other than this are one line found in two windows.
constexpr double kSameLine_px = 1.0;
/// derived: tolerance of the width in the image against the laser's: about a beam step and a pixel,
/// plus a fraction of the width.
constexpr double kWidthTolerance_px = 1.5;

vision::PixelRect widened(const vision::PixelRect& window, double reach_px) {
  const int reach = static_cast<int>(std::ceil(reach_px));
  return {window.x_px - reach, window.y_px, window.width_px + 2 * reach, window.height_px};
}

/// Finds lines in windows that are shifted across the search range in steps of half a window.
std::vector<vision::EdgeLine> lines_about(const vision::EdgeMap& map,
                                          const vision::PixelRect& window, double expected_x_px,
                                          double reach_px, const detection::Rig& rig) {
  std::vector<vision::EdgeLine> lines;
  const int step = std::max(1, window.width_px / 2);
  const int num_steps = static_cast<int>(std::ceil(reach_px / step));
  for (int i = -num_steps; i <= num_steps; ++i) {
    const vision::PixelRect slid = vision::intersection(
        {window.x_px + i * step, window.y_px, window.width_px, window.height_px}, map.area);
    if (slid.width_px < vision::tuning::kMinWindow_px || slid.height_px < window.height_px) {
      continue;
    }
    const auto line = vision::find_edge(map, slid, expected_x_px + i * step, rig.detector.edges);
    if (!line.found || line.roc < tuning::kEdgeRocMin) continue;
    const auto same = std::find_if(lines.begin(), lines.end(), [&](const auto& other) {
      return std::abs(other.x_px - line.x_px) < kSameLine_px;
    });
    if (same == lines.end()) {
      lines.push_back(line);
    } else if (line.roc > same->roc) {
      *same = line;
    }
  }
  return lines;
}

/// The area of the image that middle_offsets() reads.
vision::PixelRect offsets_area(const detection::TrunkView& view, double reach_px,
                               const detection::Rig& rig) {
  const vision::PixelRect picture = detection::picture_of(rig);
  return vision::bounding(vision::edge_reading_area(widened(view.left_edge, reach_px), picture),
                          vision::edge_reading_area(widened(view.right_edge, reach_px), picture));
}

/// Finds all pairs of edges whose distance matches the laser's width, and gives the offsets of
/// their middles from the expected column that are within `reach_px`. The search is wider than the
/// detector's windows, so that a delay can be measured.
std::vector<double> middle_offsets(const vision::EdgeMap& map, const detection::TrunkView& view,
                                   double reach_px, const detection::Rig& rig) {
  const auto left = lines_about(map, view.left_edge, view.left_x_px, reach_px, rig);
  const auto right = lines_about(map, view.right_edge, view.right_x_px, reach_px, rig);
  const double width_px = view.right_x_px - view.left_x_px;
  const double tolerance_px = kWidthTolerance_px + tuning::kWidthToleranceFraction * width_px;
  std::vector<double> offsets_px;
  for (const vision::EdgeLine& l : left) {
    for (const vision::EdgeLine& r : right) {
      if (std::abs(r.x_px - l.x_px - width_px) > tolerance_px) continue;
      const double offset_px = 0.5 * (l.x_px - view.left_x_px + (r.x_px - view.right_x_px));
      if (std::abs(offset_px) <= reach_px) offsets_px.push_back(offset_px);
    }
  }
  return offsets_px;
}

/// A trunk in view: by the scan at the exposure, and a little earlier and later.
struct TimedView {
  detection::TrunkView view, early, late;
};

std::vector<TimedView> timed_views(const detection::LaserFindings& findings,
                                   const detection::Rig& rig,
                                   const detection::ScanToPicture& to_exposure) {
  detection::ScanToPicture before = to_exposure, after = to_exposure;
  before.first_beam_dt_s -= kRateStep_s;
  after.first_beam_dt_s += kRateStep_s;
  std::vector<TimedView> views;
  for (const detection::Candidate& candidate : findings.candidates) {
    const auto view = detection::view_of(candidate.segment, rig, to_exposure);
    const auto early = detection::view_of(candidate.segment, rig, before);
    const auto late = detection::view_of(candidate.segment, rig, after);
    if (view && early && late) views.push_back({*view, *early, *late});
  }
  return views;
}

}  // namespace

std::vector<DelayObservation> delay_observations(const detection::LaserFindings& findings,
                                                 const vision::Image& image,
                                                 const detection::Rig& rig,
                                                 const detection::Motion& motion, double reach_px,
                                                 std::int32_t picture) {
  std::vector<DelayObservation> observations;
  const auto to_exposure = detection::to_picture(findings, image, rig, motion);
  const auto views = timed_views(findings, rig, to_exposure);
  vision::PixelRect reading;
  for (const TimedView& timed : views) {
    reading = vision::bounding(reading, offsets_area(timed.view, reach_px, rig));
  }
  const bool fits = image.width_px == rig.camera.intrinsics().width_px &&
                    image.height_px == rig.camera.intrinsics().height_px;
  if (reading.empty() || !fits) return observations;
  const auto pixels = vision::PictureReader(image).read(reading);
  if (!pixels) return observations;
  const vision::EdgeMap map = vision::edge_map(*pixels, rig.detector.edges);
  for (const auto& [view, early, late] : views) {
    const double moved_px = late.left_x_px + late.right_x_px - early.left_x_px - early.right_x_px;
    DelayObservation observation{picture, 0.5 * moved_px / (2.0 * kRateStep_s),
                                 motion.yaw_rate_radps, middle_offsets(map, view, reach_px, rig)};
    if (!observation.offsets_px.empty()) observations.push_back(std::move(observation));
  }
  return observations;
}

DelayEstimate estimate_delay(const std::vector<DelayObservation>& observations,
                             const DelayOptions& options) {
  require_observations(observations, options);
  const auto fit = refine(observations, most_agreed(observations));
  DelayEstimate estimate;
  estimate.num_all = static_cast<int>(observations.size());
  std::map<std::int32_t, int> pictures;
  double sum_px2 = 0.0;
  for (const DelayObservation& observation : observations) {
    const double r = fit ? least_residual(observation, fit->line) : tuning::kTukey_px;
    if (std::abs(r) >= tuning::kTukey_px) continue;
    ++estimate.num_observations;
    ++pictures[observation.picture];
    sum_px2 += r * r;
    if (std::abs(observation.yaw_rate_radps) >= options.turning_radps) ++estimate.num_turning;
  }
  if (!fit) {
    throw std::runtime_error(fmt::format(
        "{} observations cannot distinguish a delay from a rotated camera: the robot turned only "
        "to one side at one rate; drive in fast and slow curves to both sides",
        estimate.num_all));
  }
  if (estimate.num_observations >= tuning::kAgreeingMin * estimate.num_all &&
      estimate.num_turning < options.min_turning_observations) {
    throw std::runtime_error(
        fmt::format("of the observations that agree on a delay only {} are in curves ({} are "
                    "needed), so those in curves contradict each other; check the sign and scale "
                    "of the yaw rate of ODOMETRY, and that it uses the clock of the laser",
                    estimate.num_turning, options.min_turning_observations));
  }
  if (estimate.num_observations < tuning::kAgreeingMin * estimate.num_all) {
    throw std::runtime_error(fmt::format(
        "only {} of {} observations agree on a delay ({:.0f} % are needed); first check "
        "camera.phi_rad, camera.delta_m and laser.mount_* (orchard calibrate laser-camera)",
        estimate.num_observations, estimate.num_all, 100.0 * tuning::kAgreeingMin));
  }
  estimate.delay_s = fit->line.delay_s;
  estimate.se_s = std::sqrt(fit->covariance(0, 0));
  estimate.offset_px = fit->line.offset_px;
  estimate.offset_se_px = std::sqrt(fit->covariance(1, 1));
  estimate.residual_sd_px = std::sqrt(sum_px2 / std::max(1, estimate.num_observations - 2));
  estimate.num_pictures = static_cast<int>(pictures.size());
  if (estimate.se_s > options.max_se_s) {
    throw std::runtime_error(
        fmt::format("{} observations in {} pictures determine the delay only to {:.1f} ms; drive "
                    "in more and faster curves to both sides past trunks",
                    estimate.num_observations, estimate.num_pictures, 1e3 * estimate.se_s));
  }
  return estimate;
}

}  // namespace orchard::calibration
