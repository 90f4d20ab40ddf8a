// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "laser/circle_fit.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/width_config.hpp"

namespace orchard::laser {

/// What Segment::gap_left_m and gap_right_m are where nothing returns nearer than this.
inline constexpr double kGapMax_m = 2.0;

/// One object of a scan: neighbouring beams on one surface, and what the laser says of it.
struct Segment {
  std::size_t first_beam = 0;   ///< P_start, index into ranges_m
  std::size_t last_beam = 0;    ///< P_end, inclusive; below first_beam across a full turn's seam
  std::size_t middle_beam = 0;  ///< halfway between them
  int num_beams = 0;            ///< valid beams among them
  double range_m = 0.0;         ///< to the surface at bearing_rad
  double bearing_rad = 0.0;     ///< laser frame, of the middle, in (-pi, pi]
  /// Where the object begins, on first_beam's side; the image's one edge. The edge lies half a
  /// beam step outside the beam (compensated) or on it (paper). Not wrapped: start and end
  /// differ by the angle the object takes up.
  double start_bearing_rad = 0.0;
  double end_bearing_rad = 0.0;  ///< where it ends; the other edge
  double start_range_m = 0.0;    ///< r_1 of eq. 8
  double end_range_m = 0.0;      ///< r_2 of eq. 8
  /// As WidthConfig::mode measures it. With a side hidden, the circle's (`compensated`, if there is
  /// one) or what shows.
  double width_m = 0.0;
  double width_sd_m = 0.0;
  double depth_m = 0.0;         ///< extent of its points along the line of sight
  bool occluded_right = false;  ///< something nearer, or the end of the scan, hides that side
  bool occluded_left = false;
  int num_fronts = 0;  ///< thin things (grass, twigs) in front of it that hide beams of it

  /// The circle through its visible arc, laser frame; of SegmentationConfig::min_beams_circle beams
  /// or more (twice that with a side hidden), and only if one fits.
  std::optional<CircleFit> circle;
  /// Fraction of the circle's angular width that shows; 1 unless a side is hidden and a circle
  /// known.
  double visible_fraction = 1.0;
  // The shape, of five beams or more; else 0.
  double circle_rms_m = 0.0;  ///< of its points about the circle; 0 = no circle fits
  double line_rms_m = 0.0;    ///< of its points about the best straight line
  double roughness = 0.0;     ///< the lesser of both over the scanner's noise: about 1 if smooth
  double straightness = 0.0;  ///< from 0 (a circle explains it better) to 1 (a line does)
  /// From its end on that side to the next return beyond, at most kGapMax_m.
  double gap_left_m = kGapMax_m;
  double gap_right_m = kGapMax_m;

  double intensity = 0.0;  ///< mean of its beams, as the scanner gives it; 0 = none
  double intensity_max = 0.0;
  bool is_reflector = false;  ///< reaches SegmentationConfig::reflectivity_min
};

/// Cuts a scan into objects in order of bearing (Shalal et al. 2013, section 4.1, figures 5-7).
///
/// An object lies between two spikes of d(ranges)/d(steps). One missing beam (or one beam on
/// something nearer) inside an object is bridged; a single beam between two surfaces, where the
/// footprint covers both, belongs to neither. What grass or a twig parts is one object again when
/// one circle fits; what two circles fit much better than one is two. Scans of a full turn have no
/// seam.
/// Refuses nothing: beams without a believable return (0, NaN, infinity, out of range, in the
/// blind sector) count as no return.
///
/// Width, `paper`: eq. 8 with its root. `compensated`: the beam step that eq. 8 loses on average
/// is added to the angle, and all ranges count instead of the two noisy ones at the edges.
/// `laser` tells how well it measures: what a circle is held against.
std::vector<Segment> segment(const Scan& scan, const SegmentationConfig& segmentation,
                             const WidthConfig& width, const LaserConfig& laser = {});

/// Standard deviation of a measured width about mu: the trees' own (with its floor) and the part
/// that grows as the beam step does [m].
double width_sigma_m(double range_m, double bearing_step_rad, const WidthConfig& width);

/// roc_laser of a width measured at a range: exp(-(w - mu)^2 / 2 sigma^2), sigma with a floor and
/// growing with range as the beam step does. Source: Shalal et al. 2013, eqs. 9, 10.
double roc_laser(double width_m, double range_m, double bearing_step_rad, const WidthConfig& width);

}  // namespace orchard::laser
