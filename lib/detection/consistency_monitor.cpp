// SPDX-License-Identifier: BSD-3-Clause
#include "detection/consistency_monitor.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "timing/units.hpp"

namespace orchard::detection {
namespace {

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
                                          double reach_px, const Rig& rig) {
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

}  // namespace

vision::PixelRect edge_offset_area(const TrunkView& view, double reach_px, const Rig& rig) {
  const vision::PixelRect picture = picture_of(rig);
  return vision::bounding(vision::edge_reading_area(widened(view.left_edge, reach_px), picture),
                          vision::edge_reading_area(widened(view.right_edge, reach_px), picture));
}

std::vector<EdgeOffset> edge_offsets(const vision::EdgeMap& map, const TrunkView& view,
                                     double reach_px, const Rig& rig) {
  const auto left = lines_about(map, view.left_edge, view.left_x_px, reach_px, rig);
  const auto right = lines_about(map, view.right_edge, view.right_x_px, reach_px, rig);
  const double width_px = view.right_x_px - view.left_x_px;
  const double tolerance_px = kWidthTolerance_px + tuning::kWidthToleranceFraction * width_px;
  std::vector<EdgeOffset> offsets;
  for (const vision::EdgeLine& l : left) {
    for (const vision::EdgeLine& r : right) {
      if (std::abs(r.x_px - l.x_px - width_px) > tolerance_px) continue;
      const EdgeOffset offset{l.x_px - view.left_x_px, r.x_px - view.right_x_px,
                              std::min(l.roc, r.roc)};
      if (std::abs(offset.middle_px()) <= reach_px) offsets.push_back(offset);
    }
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const EdgeOffset& a, const EdgeOffset& b) { return a.roc > b.roc; });
  return offsets;
}

std::vector<CandidateEdges> find_candidate_edges(const LaserFindings& findings,
                                                 vision::PictureReader& picture, const Rig& rig,
                                                 const std::optional<Motion>& motion,
                                                 double reach_px) {
  const vision::Image& image = picture.image();
  std::vector<CandidateEdges> seen;
  const auto to_exposure = to_picture(findings, image, rig, motion);
  vision::PixelRect reading;
  for (std::size_t i = 0; i < findings.candidates.size(); ++i) {
    const auto view = view_of(findings.candidates[i].segment, rig, to_exposure);
    if (!view) continue;
    seen.push_back({i, *view, {}});
    reading = vision::bounding(reading, edge_offset_area(*view, reach_px, rig));
    picture.expect(reading_area(*view, rig));
  }
  const bool fits = image.width_px == rig.camera.intrinsics().width_px &&
                    image.height_px == rig.camera.intrinsics().height_px;
  if (reading.empty() || !fits) return {};
  const auto pixels = picture.read(reading);
  if (!pixels) return {};
  const vision::EdgeMap map = vision::edge_map(*pixels, rig.detector.edges);
  for (CandidateEdges& candidate : seen) {
    candidate.offsets = edge_offsets(map, candidate.view, reach_px, rig);
  }
  seen.erase(std::remove_if(seen.begin(), seen.end(),
                            [](const CandidateEdges& c) { return c.offsets.empty(); }),
             seen.end());
  return seen;
}

namespace {

/// derived: message time between two comparisons [s]: edges are costly.
constexpr double kPeriod_s = 1.0;

/// derived: 1 in 16,000; half width of the median's confidence interval [standard deviations].
/// Among bushes the edges lie anywhere in the search window, and the median of some tens of them is
/// off by chance.
constexpr double kCertain_sigma = 4.0;

/// Returns the end of the median's confidence interval that is nearer to zero, and zero if that
/// lies within. How many of n values lie below the true median is binomial with variance n / 4,
/// whatever their distribution.
double certain_median(const std::vector<double>& values) {
  const double half_width = 0.5 * kCertain_sigma / std::sqrt(static_cast<double>(values.size()));
  const double low = geometry::quantile(values, std::max(0.0, 0.5 - half_width));
  const double high = geometry::quantile(values, std::min(1.0, 0.5 + half_width));
  return low > 0.0 ? low : std::min(high, 0.0);
}

}  // namespace

ConsistencyMonitor::ConsistencyMonitor(const ConsistencyConfig& config, double focal_px)
    : config_(config), focal_px_(focal_px) {}

bool ConsistencyMonitor::is_due(std::int64_t utime) const {
  if (!config_.enabled) return false;
  return last_utime_ == INT64_MIN || timing::seconds(utime - last_utime_) >= kPeriod_s;
}

void ConsistencyMonitor::add(std::int64_t utime, const std::vector<double>& offsets_px) {
  if (first_utime_ == INT64_MIN) first_utime_ = utime;
  if (raised_) raised_us_ += utime - last_utime_;
  last_utime_ = utime;
  for (const double offset_px : offsets_px) observations_.push_back({utime, offset_px});
  while (!observations_.empty() &&
         timing::seconds(utime - observations_.front().utime) > tuning::kDisagreementWindow_s) {
    observations_.pop_front();
  }
  const bool is_long = timing::seconds(utime - first_utime_) >= tuning::kDisagreementWindow_s;
  if (!is_long || num_observations() < tuning::kObjectsMin) return;  // too few: keep the state
  std::vector<double> values;
  values.reserve(observations_.size());
  for (const Observation& observation : observations_) values.push_back(observation.offset_px);
  median_px_ = geometry::median(values);
  raised_ = raised_ ? std::abs(degrees(median_px_)) >= tuning::kClear_deg
                    : std::abs(degrees(certain_median(values))) >= tuning::kWarn_deg;
  if (raised_ && std::abs(median_px_) > std::abs(worst_px_)) worst_px_ = median_px_;
}

double ConsistencyMonitor::degrees(double offset_px) const {
  return std::atan(offset_px / focal_px_) * 180.0 / geometry::kPi;
}

std::string ConsistencyMonitor::disagreement(const char* verb, double offset_px,
                                             double duration_s) const {
  return fmt::format(
      "laser and image edges {} by {:.1f} px ({:.1f} deg, image to the {}) for {:.0f} s: check "
      "camera.phi_rad (orchard calibrate laser-camera) or camera.delay_s (orchard "
      "calibrate delay)",
      verb, std::abs(offset_px), std::abs(degrees(offset_px)), offset_px > 0.0 ? "right" : "left",
      duration_s);
}

std::string ConsistencyMonitor::warning() const {
  if (!raised_) return {};
  return disagreement("disagree", median_px_,
                      tuning::kDisagreementWindow_s + timing::seconds(raised_us_));
}

std::string ConsistencyMonitor::run_summary() const {
  if (worst_px_ == 0.0) return {};
  return disagreement("disagreed", worst_px_,
                      tuning::kDisagreementWindow_s + timing::seconds(raised_us_));
}

}  // namespace orchard::detection
