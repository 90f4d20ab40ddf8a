// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "laser/candidates.hpp"
#include "laser/circle_fit.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"

namespace orchard::laser {

/// derived: beyond a trunk and its neighbour's nothing is compared. Upper limit of
/// Segment::gap_left_m and gap_right_m; also their value without a nearer return.
inline constexpr double kGapMax_m = 2.0;

/// One object of a scan: neighbouring beams on one surface, and their measurements.
struct Segment {
  std::size_t first_beam = 0;   ///< P_start, index into ranges_m
  std::size_t last_beam = 0;    ///< P_end, inclusive; < first_beam across a 360 degree scan's seam
  std::size_t middle_beam = 0;  ///< halfway between first_beam and last_beam
  int num_beams = 0;            ///< number of valid beams
  double range_m = 0.0;         ///< to the surface at bearing_rad
  double bearing_rad = 0.0;     ///< of the middle, laser frame, in (-pi, pi]
  /// Bearing of the edge on first_beam's side. The edge lies outside the beam by half a beam step
  /// less half the laser spot (compensated) or on the beam (paper). Not wrapped: start and end
  /// differ by the angle that the object subtends.
  double start_bearing_rad = 0.0;
  double end_bearing_rad = 0.0;  ///< bearing of the edge on last_beam's side
  double start_range_m = 0.0;    ///< r_1 of eq. 8
  double end_range_m = 0.0;      ///< r_2 of eq. 8
  /// Width according to WidthConfig::mode. With a hidden side: the circle's diameter
  /// (`compensated`, if a circle fits) or the visible width.
  double width_m = 0.0;
  double width_sd_m = 0.0;
  double depth_m = 0.0;         ///< extent of its points along the line of sight
  bool occluded_right = false;  ///< this side is hidden by a nearer object or the end of the scan
  bool occluded_left = false;

  /// Circle fitted to the visible arc, laser frame. Needs SegmentationConfig::min_beams_circle
  /// beams (twice as many with a hidden side), an acceptable chi2 per degree of freedom, and with a
  /// hidden side that it covers the visible beams.
  std::optional<CircleFit> circle;
  /// Visible fraction of the circle's angular width; 1 unless a side is hidden and a circle fits.
  double visible_fraction = 1.0;
  // Shape, for five beams or more; otherwise 0.
  double circle_rms_m = 0.0;  ///< RMS distance of the points from the circle; 0 = no circle fits
  double line_rms_m = 0.0;    ///< RMS distance of the points from the best straight line
  double roughness = 0.0;     ///< the smaller RMS over the range noise: about 1 if smooth
  double straightness = 0.0;  ///< from 0 (a circle fits better) to 1 (a line fits better)
  /// Distance from the end on this side to the next return beyond, at most kGapMax_m.
  double gap_left_m = kGapMax_m;
  double gap_right_m = kGapMax_m;

  double intensity = 0.0;  ///< mean of its beams in the scanner's own unit; 0 = none
  double intensity_max = 0.0;
  bool is_reflector = false;  ///< intensity_max reaches SegmentationConfig::reflectivity_min
};

/// Segments a scan into objects in order of bearing (Shalal et al. 2013, section 4.1, figures 5-7).
///
/// An object lies between two spikes of d(ranges)/d(steps). One missing beam (or one beam on a
/// nearer object) inside an object is bridged; a single beam whose footprint covers two surfaces
/// (mixed pixel) belongs to neither. A segment is split if two circles
/// fit much better than one. 360 degree scans have no seam.
/// Invalid ranges (0, NaN, infinity, out of range, in the blind sector) count as no return; nothing
/// is thrown.
///
/// Width: `paper` is eq. 8 with its root. `compensated` adds the beam step that eq. 8 loses on
/// average to the angle, and uses all ranges instead of the two noisy ones at the edges. `laser`
/// gives the range noise for the circle fit and the spot size. `trunk_roc_min`: roc_laser from
/// which an object with a reflector is a trunk that wears it, and is not divided.
std::vector<Segment> segment(const Scan& scan, const SegmentationConfig& segmentation,
                             const WidthConfig& width, const LaserConfig& laser = {},
                             double trunk_roc_min = kThreeSigmaRoc);

/// Standard deviation of a measured width about the mean mu [m]: the trees' own scatter (with a
/// floor) plus a part proportional to range x beam step.
double width_sigma_m(double range_m, double bearing_step_rad, const WidthConfig& width);

/// roc_laser of a width measured at a range: exp(-(w - mu)^2 / 2 sigma^2), with sigma from
/// width_sigma_m(). Source: Shalal et al. 2013, eqs. 9, 10.
double roc_laser(double width_m, double range_m, double bearing_step_rad, const WidthConfig& width);

/// Measures one segment candidate: range, bearing, width (Shalal et al. 2013, eq. 8), intensity and
/// shape. `fit` must belong to the same scan; it caches the circles fitted to its candidates.
Segment measure(const Scan& scan, const Beams& beams, const Candidate& candidate,
                const SegmentationConfig& config, const WidthConfig& width,
                const LaserConfig& laser, CandidateFitter& fit);

}  // namespace orchard::laser
