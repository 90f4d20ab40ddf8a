// SPDX-License-Identifier: BSD-3-Clause
#include "laser/segment.hpp"

#include <algorithm>
#include <cmath>

#include "laser/beams.hpp"
#include "laser/candidate.hpp"
#include "laser/measure.hpp"
#include "laser/splitting/bright_cut.hpp"
#include "laser/splitting/split_touching.hpp"

namespace orchard::laser {
namespace {

/// Whether a single-beam candidate is a mixed pixel between the surfaces on both sides.
bool is_mixed(const Beams& beams, const Candidate& candidate) {
  const float before_m = beams.range_around_m(candidate.first - 1);
  const float after_m = beams.range_around_m(candidate.first + 1);
  const float here_m = beams.range_m(candidate.first);
  return before_m > 0.0f && after_m > 0.0f && (here_m - before_m) * (after_m - here_m) > 0.0f;
}

}  // namespace

std::vector<Segment> segment(const Scan& scan, const SegmentationConfig& segmentation,
                             const WidthConfig& width, const LaserConfig& laser,
                             double trunk_roc_min) {
  std::vector<Segment> segments;
  if (scan.ranges_m.empty() || !std::isfinite(scan.bearing_step_rad) ||
      scan.bearing_step_rad == 0.0 || !std::isfinite(scan.bearing_min_rad)) {
    return segments;
  }
  const Beams beams(scan, segmentation);
  std::vector<Candidate> candidates = find_candidates(beams);
  CandidateFitter fit(beams, segmentation, laser);
  for (Candidate& candidate : candidates) trim_border(beams, candidate);
  split_touching(beams, segmentation, width, laser, fit, candidates);
  const auto measured = [&](const Candidate& candidate) {
    return measure(scan, beams, candidate, segmentation, width, laser, fit);
  };
  if (beams.has_bright()) {
    cut_at_bright(beams, candidates, [&](const Candidate& candidate) {
      const Segment s = measured(candidate);
      return roc_laser(s.width_m, s.range_m, scan.bearing_step_rad, width) >= trunk_roc_min;
    });
  }
  for (const Candidate& candidate : candidates) {
    if (!candidate.is_bright) {
      if (candidate.num_beams < segmentation.min_beams) continue;
      if (candidate.num_beams == 1 && is_mixed(beams, candidate)) continue;
    }
    const Segment s = measured(candidate);
    if (s.width_m <= segmentation.width_max_m) segments.push_back(s);
  }
  std::sort(segments.begin(), segments.end(), [](const Segment& a, const Segment& b) {
    return a.bearing_rad != b.bearing_rad ? a.bearing_rad < b.bearing_rad
                                          : a.first_beam < b.first_beam;
  });
  return segments;
}

double width_sigma_m(double range_m, double bearing_step_rad, const WidthConfig& width) {
  const double quantum_m = width.sd_per_beam_step * range_m * std::abs(bearing_step_rad);
  return std::hypot(std::max(width.sd_m, WidthConfig::kSdFloor_m), quantum_m);
}

double roc_laser(double width_m, double range_m, double bearing_step_rad,
                 const WidthConfig& width) {
  const double sigma_m = width_sigma_m(range_m, bearing_step_rad, width);
  const double deviation = (width_m - width.mean_m) / sigma_m;
  // Shalal et al. 2013, eq. 10: the density of eq. 9 at the width over that at the mean.
  return std::exp(-0.5 * deviation * deviation);
}

}  // namespace orchard::laser
