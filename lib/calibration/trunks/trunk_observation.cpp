// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/trunk_observation.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "detection/detect.hpp"
#include "detection/trunk_view.hpp"
#include "laser/segment.hpp"
#include "vision/appearance.hpp"
#include "vision/decode.hpp"

namespace orchard::calibration {
namespace {

// derived: from the reach of a window's bands.
/// Distance of a window beside a trunk in window widths, so that its bands do not cover the trunk.
constexpr int kWidthsOff = 3;

/// Windows of all objects of the scan in the image; windows "beside" must not overlap any of them.
std::vector<vision::PixelRect> windows_of(const std::vector<laser::Segment>& segments,
                                          const detection::Rig& rig) {
  std::vector<vision::PixelRect> windows;
  for (const laser::Segment& segment : segments) {
    if (const auto view = detection::view_of(segment, rig)) {
      windows.push_back(detection::trunk_window(*view, rig));
    }
  }
  return windows;
}

/// Adds the image features of one segment; false if it is not fully in view.
bool observe(TrunkObservation& seen, const laser::Segment& segment, const vision::Image& image,
             const std::vector<vision::PixelRect>& taken, const detection::Rig& rig) {
  const auto view = detection::view_of(segment, rig);
  if (!view) return false;
  const vision::PixelRect picture = detection::picture_of(rig);
  const vision::PixelRect window = detection::trunk_window(*view, rig);
  const auto reading = vision::bounding(vision::bounding(view->centre, window),
                                        vision::appearance_reading_area(window, picture));
  const auto pixels = vision::decode(image, reading);
  if (!pixels) return false;
  const std::vector<vision::PixelBlock> exposures = vision::learnt_exposures(*pixels);
  const auto look_at = [&](const vision::PixelRect& rect,
                           std::vector<WindowObservation>& observations) {
    for (const vision::PixelBlock& block : exposures) {
      observations.push_back(
          {vision::appearance_features(block, rect), vision::hue_histogram(block, rect)});
    }
  };
  seen.hues = vision::hue_histogram(*pixels, view->centre);
  seen.light = vision::window_light(*pixels, view->centre);
  look_at(window, seen.on);
  for (const int side : {-1, 1}) {
    vision::PixelRect beside = window;
    beside.x_px += side * kWidthsOff * window.width_px;
    const bool free = std::all_of(taken.begin(), taken.end(), [&](const auto& other) {
      return vision::intersection(beside, other).empty();
    });
    if (free && picture.contains(beside)) look_at(beside, seen.beside);
  }
  return true;
}

}  // namespace

std::vector<TrunkObservation> observe_trunks(const laser::Scan& scan, const vision::Image* image,
                                             const detection::Rig& rig, int min_beams) {
  std::vector<TrunkObservation> observations;
  if (rig.has_camera && !image) return observations;
  const auto segments = laser::segment(scan, rig.detector.segmentation, rig.detector.width,
                                       rig.laser, detection::DetectorConfig::kRocLaserMin);
  const auto taken = rig.has_camera ? windows_of(segments, rig) : std::vector<vision::PixelRect>{};
  for (const laser::Segment& segment : segments) {
    if (segment.occluded_left || segment.occluded_right) continue;
    if (segment.num_beams < min_beams) continue;
    detection::Detection placed;
    detection::place_in_base(placed, segment, scan, false, rig);
    TrunkObservation observation;
    observation.utime = scan.utime;
    observation.x_m = placed.centre_x_m;
    observation.y_m = placed.centre_y_m;
    observation.range_m = segment.range_m;
    observation.beam_step_rad = scan.bearing_step_rad;
    observation.width_m = segment.width_m;
    if (rig.has_camera && !observe(observation, segment, *image, taken, rig)) continue;
    observations.push_back(std::move(observation));
  }
  return observations;
}

}  // namespace orchard::calibration
