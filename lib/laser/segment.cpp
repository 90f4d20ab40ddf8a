// SPDX-License-Identifier: BSD-3-Clause
#include "laser/segment.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "laser/candidates.hpp"
#include "laser/splitting.hpp"
#include "laser/tuning.hpp"

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

namespace {

using geometry::kPi;
using geometry::wrap_angle_rad;

/// derived: min number of beams for a shape: a line has two parameters, a circle three.
constexpr std::size_t kFewestBeamsOfAShape = 5;
/// derived: 95 %; a circle is rejected if it does not cover the visible beams even with a radius
/// this many standard deviations larger. Beams that miss a circle have no weight in the fit.
constexpr double kRadius_sigma = 2.0;

/// derived: lower limit of the measured angular width, in beam steps: subtracting a spot wider than
/// the beam step from a thin object would give zero or less.
constexpr double kThinnest_beams = 0.1;

/// derived: max half angle that a circle may subtend; keeps the scanner outside the circle.
constexpr double kWidest_rad = 0.45 * kPi;

/// Distance between two returns: Shalal et al. 2013, eq. 8 and figure 7, with the root that the
/// paper omits.
double chord_m(double r1_m, double r2_m, double angle_rad) {
  const double square_m2 = r1_m * r1_m + r2_m * r2_m - 2.0 * r1_m * r2_m * std::cos(angle_rad);
  return std::sqrt(std::max(0.0, square_m2));
}

/// Mean range of the near side of a circle over the angle that it subtends, for a centre at
/// distance 1. `sine`: of half that angle, which is also the radius. The mean of the root is a
/// series up to the fourth power of the sine.
double mean_range_of_circle(double sine) {
  if (sine < 1e-6) return 1.0;
  return sine / std::asin(sine) - 0.25 * kPi * sine * (1.0 - sine * sine / 24.0);
}

/// Distance from an object's end to the next return beyond it, at most kGapMax_m.
double gap_m(const Beams& beams, std::ptrdiff_t end, std::ptrdiff_t outwards) {
  const double range_m = beams.range_m(end);
  // Beyond this angle every return is farther than kGapMax_m: its distance from the end's line of
  // sight is a lower bound.
  const double farthest_rad = range_m > kGapMax_m ? std::asin(kGapMax_m / range_m) : 2.0 * kPi;
  for (std::ptrdiff_t k = 1; k < beams.size(); ++k) {
    const double angle_rad = static_cast<double>(k) * beams.step_rad();
    if (angle_rad > farthest_rad) break;
    const double next_m = beams.range_around_m(end + k * outwards);
    if (next_m > 0.0) return std::min(chord_m(range_m, next_m, angle_rad), kGapMax_m);
  }
  return kGapMax_m;
}

/// RMS distance of the points from the best straight line.
double line_rms_m(const Arc& arc) {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < arc.ranges_m.size(); ++i) {
    const double x_m = arc.ranges_m[i] * arc.cosines[i] - arc.ranges_m[0];
    const double y_m = arc.ranges_m[i] * arc.sines[i];
    x += x_m;
    y += y_m;
    xx += x_m * x_m;
    xy += x_m * y_m;
    yy += y_m * y_m;
  }
  const double n = static_cast<double>(arc.ranges_m.size());
  const double cxx = xx - x * x / n, cxy = xy - x * y / n, cyy = yy - y * y / n;
  const double smallest = 0.5 * (cxx + cyy) - std::hypot(0.5 * (cxx - cyy), cxy);
  return std::sqrt(std::max(0.0, smallest) / (n - 2.0));
}

double circle_rms_m(const Arc& arc, const CircleFit& circle) {
  double sum_m2 = 0.0;
  for (std::size_t i = 0; i < arc.ranges_m.size(); ++i) {
    const double x_m = arc.ranges_m[i] * arc.cosines[i] - circle.x_m;
    const double y_m = arc.ranges_m[i] * arc.sines[i] - circle.y_m;
    sum_m2 += geometry::square(std::hypot(x_m, y_m) - circle.radius_m);
  }
  return std::sqrt(sum_m2 / (static_cast<double>(arc.ranges_m.size()) - 3.0));
}

/// Angle that a circle subtends.
double full_angle_rad(const CircleFit& circle) {
  return 2.0 * std::asin(std::min(1.0, circle.radius_m / std::hypot(circle.x_m, circle.y_m)));
}

/// Angle that a circle subtends if its radius is kRadius_sigma standard deviations larger.
double widest_angle_rad(const CircleFit& circle) {
  CircleFit wide = circle;
  wide.radius_m += kRadius_sigma * std::sqrt(circle.covariance[5]);
  return full_angle_rad(wide);
}

/// Transforms a circle from the arc's frame to the laser frame: rotates it by the bearing of the
/// first beam and mirrors it for clockwise scanners.
CircleFit in_laser_frame(const CircleFit& local, double bearing_rad, bool clockwise) {
  const double c = std::cos(bearing_rad), s = std::sin(bearing_rad);
  const double m = clockwise ? -1.0 : 1.0;
  CircleFit fit = local;
  fit.x_m = c * local.x_m - s * m * local.y_m;
  fit.y_m = s * local.x_m + c * m * local.y_m;
  const auto& [xx, xy, yy, xr, mirrored_yr, rr] = local.covariance;
  const double yr = m * mirrored_yr;
  const auto turned = geometry::rotated_covariance({xx, m * xy, yy}, bearing_rad);
  fit.covariance = {turned[0], turned[1], turned[2], c * xr - s * yr, s * xr + c * yr, rr};
  return fit;
}

void measure_intensity(const Scan& scan, const Beams& beams, const Candidate& candidate,
                       double brightest_from, Segment& s) {
  if (!scan.has_intensities()) return;
  double sum = 0.0;
  int count = 0;
  for_each_beam(beams, candidate, [&](std::ptrdiff_t i) {
    const double intensity = scan.intensities[beams.index(i)];
    if (!std::isfinite(intensity)) return;
    sum += intensity;
    s.intensity_max = std::max(s.intensity_max, intensity);
    ++count;
  });
  if (count > 0) s.intensity = sum / count;
  s.is_reflector = brightest_from > 0.0 && s.intensity_max >= brightest_from;
}

/// Fits a circle and a line and derives roughness and straightness from them.
void measure_shape(const Scan& scan, const Candidate& candidate, const Sides& sides,
                   const SegmentationConfig& config, const LaserConfig& laser, CandidateFitter& fit,
                   Segment& s) {
  const Arc& arc = fit.arc(candidate);
  const std::size_t n = arc.ranges_m.size();
  const bool hidden = sides.before.hidden || sides.after.hidden;
  const bool enough = static_cast<int>(n) >= config.min_beams_circle * (hidden ? 2 : 1);
  if (!enough && n < kFewestBeamsOfAShape) return;
  const double range_sd_m = laser.range_sd_at(s.range_m);
  const std::optional<CircleFit>& circle = fit.any(candidate);
  if (n >= kFewestBeamsOfAShape) {
    s.line_rms_m = line_rms_m(arc);
    s.circle_rms_m = circle ? circle_rms_m(arc, *circle) : 0.0;
    const double best_m = circle ? std::min(s.line_rms_m, s.circle_rms_m) : s.line_rms_m;
    s.roughness = best_m / range_sd_m;
    const double line2_m2 = geometry::square(s.line_rms_m),
                 circle2_m2 = geometry::square(s.circle_rms_m);
    s.straightness = !circle                       ? 1.0
                     : line2_m2 + circle2_m2 > 0.0 ? circle2_m2 / (line2_m2 + circle2_m2)
                                                   : 0.5;
  }
  if (!circle || !enough || circle->chi2_per_dof() > tuning::kWorstFit) return;
  const double full_rad = full_angle_rad(*circle);
  const double visible_rad = arc.high_side_rad - arc.low_side_rad;
  if (hidden) {
    if (visible_rad > widest_angle_rad(*circle) + 2.0 * std::abs(scan.bearing_step_rad)) return;
    s.visible_fraction = std::min(1.0, visible_rad / full_rad);
  }
  s.circle = in_laser_frame(*circle, scan.bearing_rad(static_cast<double>(s.first_beam)),
                            scan.bearing_step_rad < 0.0);
}

}  // namespace

Segment measure(const Scan& scan, const Beams& beams, const Candidate& candidate,
                const SegmentationConfig& config, const WidthConfig& width,
                const LaserConfig& laser, CandidateFitter& fit) {
  const double step_rad = beams.step_rad();
  const double span_beams = static_cast<double>(candidate.last - candidate.first);
  const Sides sides = sides_of(beams, candidate, laser);
  Segment s;
  s.first_beam = beams.index(candidate.first);
  s.last_beam = beams.index(candidate.last);
  s.middle_beam = beams.index(candidate.first + (candidate.last - candidate.first) / 2);
  s.num_beams = candidate.num_beams;
  s.start_range_m = beams.range_m(candidate.first);
  s.end_range_m = beams.range_m(candidate.last);

  double sum_m = 0.0;
  double nearest_m = s.start_range_m;
  double farthest_m = s.start_range_m;
  for_each_beam(beams, candidate, [&](std::ptrdiff_t i) {
    const double range_m = beams.range_m(i);
    sum_m += range_m;
    nearest_m = std::min(nearest_m, range_m);
    farthest_m = std::max(farthest_m, range_m);
  });
  const double mean_m = sum_m / candidate.num_beams;
  s.depth_m = farthest_m - nearest_m;

  const double edge_beams_before =
      width.mode == WidthMode::kPaper ? 0.0 : sides.before.beyond_beams;
  const double edge_beams_after = width.mode == WidthMode::kPaper ? 0.0 : sides.after.beyond_beams;
  // A circle of radius R at distance D subtends the angle 2 asin(R / D).
  const double filled_beams =
      std::max(span_beams + sides.before.beyond_beams + sides.after.beyond_beams, kThinnest_beams);
  const double half_angle_rad = std::min(0.5 * filled_beams * step_rad, kWidest_rad);
  const double sine = std::sin(half_angle_rad);
  const double mean_per_distance = mean_range_of_circle(sine);
  const double centre_m = mean_m / mean_per_distance;
  const double radius_m = centre_m * sine;
  const double to_front_m = mean_m - (centre_m - radius_m);
  s.range_m = std::clamp(mean_m - to_front_m, nearest_m, farthest_m);

  const double paper_m = chord_m(s.start_range_m, s.end_range_m, span_beams * step_rad);
  if (width.mode == WidthMode::kPaper) {
    s.width_m = paper_m;
  } else {
    // The width of a flat object seen at an angle is its chord.
    const double slant_m = std::abs(s.end_range_m - s.start_range_m);
    const bool slants = slant_m > radius_m + config.jump_m;
    s.width_m = slants ? std::max(2.0 * radius_m, paper_m + mean_m * step_rad) : 2.0 * radius_m;
  }
  const double sides_sd_beams = std::hypot(sides.before.sd_beams, sides.after.sd_beams);
  // The width is angle x range: add the noise of the mean range and the error common to all beams.
  const double range_sd =
      std::hypot(laser.range_sd_at(mean_m) / (mean_m * std::sqrt(static_cast<double>(s.num_beams))),
                 laser.target_sd_fraction);
  s.width_sd_m = std::max(std::hypot(mean_m * step_rad * sides_sd_beams, s.width_m * range_sd),
                          0.1 * WidthConfig::kSdFloor_m);

  const double first = static_cast<double>(s.first_beam);
  s.start_bearing_rad = scan.bearing_rad(first - edge_beams_before);
  s.end_bearing_rad = scan.bearing_rad(first + span_beams + edge_beams_after);
  s.bearing_rad = wrap_angle_rad(0.5 * (s.start_bearing_rad + s.end_bearing_rad));

  const bool upwards = scan.bearing_step_rad > 0.0;
  s.occluded_right = upwards ? sides.before.hidden : sides.after.hidden;
  s.occluded_left = upwards ? sides.after.hidden : sides.before.hidden;
  const double gap_before_m = gap_m(beams, candidate.first, -1),
               gap_after_m = gap_m(beams, candidate.last, 1);
  s.gap_right_m = upwards ? gap_before_m : gap_after_m;
  s.gap_left_m = upwards ? gap_after_m : gap_before_m;
  measure_intensity(scan, beams, candidate, config.reflectivity_min, s);
  measure_shape(scan, candidate, sides, config, laser, fit, s);
  if (s.circle && (s.occluded_left || s.occluded_right) && width.mode == WidthMode::kCompensated) {
    s.width_m = 2.0 * s.circle->radius_m;
    s.width_sd_m = std::max(2.0 * std::sqrt(s.circle->covariance[5]), s.width_sd_m);
  }
  return s;
}

}  // namespace orchard::laser
