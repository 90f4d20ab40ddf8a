// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "detection/adaptation/adaptation.hpp"
#include "detection/detection.hpp"
#include "detection/motion.hpp"
#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "laser/segment.hpp"
#include "vision/image.hpp"
#include "vision/picture_reader.hpp"

namespace orchard::detection {

/// An object that the laser takes for a possible trunk, so that the camera must look at it.
struct Candidate {
  std::size_t index = 0;  ///< into LaserFindings::detections.trunks
  laser::Segment segment;
};

/// What the laser alone shows: all that can be known of a scan before its picture is there.
struct LaserFindings {
  Detections detections;              ///< candidates are UNSEEN still
  std::vector<Candidate> candidates;  ///< none of a rig without a camera
  /// Reflectors count (segmentation.reflector) but the scan has no intensities: all is UNSEEN.
  bool intensities_missing = false;
  double beam_period_s = 0.0;  ///< of the scan; 0 = unknown
};

/// What a scan and its picture show.
struct DetectResult {
  Detections detections;             ///< seq is left 0: the sender's
  bool image_needed = false;         ///< a candidate stands in its view
  bool image_unusable = false;       ///< needed, but did not decode or of another size
  bool intensities_missing = false;  ///< as in LaserFindings
  std::vector<AdaptationObservation>
      observations;  ///< at candidates; none unless adaptation is enabled
};

/// The laser's half of the detector: segment, width. A rig without a camera needs no other.
LaserFindings find_by_laser(const laser::Scan& scan, const Rig& rig);

/// From each beam to the exposure of a picture, camera.delay_s before its utime; none without a
/// motion.
std::optional<ScanToPicture> to_picture(const LaserFindings& findings, const vision::Image& image,
                                        const Rig& rig, const std::optional<Motion>& motion);

/// The camera's half: project, colour, edges, fuse. `picture` may be null; `motion` as in detect().
DetectResult judge_by_camera(LaserFindings findings, vision::PictureReader* picture, const Rig& rig,
                             const std::optional<Motion>& motion = std::nullopt);

/// The paper's detector: segment, width, project, colour, edges, fuse. `image` may be null.
///
/// An object that the laser rejects is an OBJECT whatever the camera sees. A candidate that the
/// camera does not see in full, or of which something nearer hides a side, is UNSEEN; its roc_tree
/// stays 0. Of a rig without a camera roc_tree is roc_laser. A pure function; only the windows of
/// the picture are decoded. Source: Shalal et al. 2013, section 4 and figure 4.
/// `motion` of base about the picture's time, where known, moves each object's points from their
/// own beams' time to the picture's exposure.
DetectResult detect(const laser::Scan& scan, const vision::Image* image, const Rig& rig,
                    const std::optional<Motion>& motion = std::nullopt);

}  // namespace orchard::detection
