// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "laser/scan.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/width_config.hpp"

namespace orchard::laser {

/// One object of a scan: neighbouring beams on one surface, and what the laser says of it.
struct Segment {
  std::size_t first_beam = 0;     ///< P_start, index into ranges_m
  std::size_t last_beam = 0;      ///< P_end, inclusive
  int num_beams = 0;              ///< valid beams among them
  double range_m = 0.0;           ///< to the surface at bearing_rad
  double bearing_rad = 0.0;       ///< laser frame, of the middle
  double start_bearing_rad = 0.0; ///< where the object begins; the image's one edge
  double end_bearing_rad = 0.0;   ///< where it ends; the other edge
  double start_range_m = 0.0;
  double end_range_m = 0.0;
  double width_m = 0.0;           ///< as WidthConfig::mode measures it
  double width_sd_m = 0.0;
  double depth_m = 0.0;           ///< extent of its points along the line of sight
  bool occluded_right = false;    ///< something nearer, or the end of the scan, on that side
  bool occluded_left = false;
};

/// Cuts a scan into objects in order of bearing (Shalal et al. 2013, section 4.1, figures 5-7).
///
/// Refuses nothing: beams without a believable return separate or are bridged as configured.
std::vector<Segment> segment(const Scan& scan, const SegmentationConfig& segmentation,
                             const WidthConfig& width);

/// roc_laser of a width measured at a range: exp(-(w - mu)^2 / 2 sigma^2), sigma with a floor and
/// growing with range as the beam step does. Source: Shalal et al. 2013, eqs. 9, 10.
double roc_laser(double width_m, double range_m, double bearing_step_rad, const WidthConfig& width);

}  // namespace orchard::laser
