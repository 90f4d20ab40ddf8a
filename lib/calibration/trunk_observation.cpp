// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunk_observation.hpp"

#include <optional>

#include "detection/centre.hpp"
#include "detection/trunk_view.hpp"
#include "laser/segment.hpp"
#include "vision/decode.hpp"

namespace orchard::calibration {

std::vector<TrunkObservation> observe_trunks(const laser::Scan& scan, const vision::Image* image,
                                             const detection::Rig& rig, int min_beams) {
  std::vector<TrunkObservation> observations;
  if (rig.has_camera && !image) return observations;
  for (const laser::Segment& segment :
       laser::segment(scan, rig.detector.segmentation, rig.detector.width, rig.laser)) {
    if (segment.occluded_left || segment.occluded_right || segment.num_beams < min_beams) continue;
    detection::Detection placed;
    detection::place_in_base(placed, segment, scan, false, rig);
    TrunkObservation observation;
    observation.utime = scan.utime;
    observation.x_m = placed.centre_x_m;
    observation.y_m = placed.centre_y_m;
    observation.width_m = segment.width_m;
    if (rig.has_camera) {
      const auto view = detection::view_of(segment, rig);
      if (!view) continue;
      const auto pixels = vision::decode(*image, view->centre);
      if (!pixels) continue;
      observation.hues = vision::hue_histogram(*pixels, view->centre, rig.detector.colour);
    }
    observations.push_back(observation);
  }
  return observations;
}

}  // namespace orchard::calibration
