// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "detection/detection.hpp"
#include "detection/motion.hpp"
#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "laser/segment.hpp"
#include "vision/decode.hpp"
#include "vision/image.hpp"

namespace orchard::detection {

/// An object that may be a trunk and is to be judged by the camera.
struct Candidate {
  std::size_t index = 0;  ///< into LaserFindings::detections.trunks
  laser::Segment segment;
  double angle_sd_rad = 0.0;  ///< of the angle between its sides, by detector.width
};

/// Result of the laser's half of the detector: everything that does not need the image.
struct LaserFindings {
  Detections detections;              ///< candidates are UNSEEN, or OBJECT by their width
  std::vector<Candidate> candidates;  ///< empty for a rig without a camera
  /// Reflectors are used (segmentation.reflector), but the scan has no intensities; all objects are
  /// UNSEEN.
  bool intensities_missing = false;
  double beam_period_s = 0.0;                                    ///< of the scan; 0 = unknown
  Eigen::Matrix2d plane_of_level = Eigen::Matrix2d::Identity();  ///< of the scan
};

/// Result of the detector for a scan and its image.
struct DetectResult {
  Detections detections;             ///< seq is 0; the sender sets it
  bool image_needed = false;         ///< a candidate is in the camera's view
  bool image_unusable = false;       ///< needed, but it does not decode or has another size
  bool intensities_missing = false;  ///< as in LaserFindings
};

/// The laser's half of the detector: segmentation and width test. Complete for a rig without a
/// camera.
LaserFindings find_by_laser(const laser::Scan& scan, const Rig& rig);

/// From a scan to the exposure of an image, which is camera.delay_s before its utime.
ScanToPicture to_picture(const LaserFindings& findings, const vision::Image& image, const Rig& rig,
                         const std::optional<Motion>& motion);

/// The camera's half of the detector: project, colour, edges, fuse. `picture` may be null; `motion`
/// as in detect().
DetectResult judge_by_camera(LaserFindings findings, vision::PictureReader* picture, const Rig& rig,
                             const std::optional<Motion>& motion = std::nullopt);

/// Detects trees and other objects in a scan and its image: segment, width, project, colour, edges,
/// fuse. `image` may be null.
///
/// An object that the laser rejects is an OBJECT; the camera examines it only if, with
/// Decision::kProbability, its answer could still make a tree of it. A candidate that
/// is not fully inside the image or has a hidden side (see visible_fraction_min) is UNSEEN with
/// roc_tree 0. For a rig without a camera roc_tree is roc_laser. A pure function; only the windows
/// of the image are decoded. `motion`: of base about the time of the image, if known; moves each
/// object's points from the time of their beams to the exposure. Source: Shalal et al. 2013,
/// section 4 and figure 4.
DetectResult detect(const laser::Scan& scan, const vision::Image* image, const Rig& rig,
                    const std::optional<Motion>& motion = std::nullopt);

/// Fills a detection's surface and centre in the base frame, and the centre's covariance. The
/// centre is that of the segment's circle, or without a circle range + radius along the bearing.
/// `is_trunk`: the width model applies, and the radius is the variance-weighted mean of the
/// measured radius and the model's. Source: generalises Shalal et al. 2013, eqs. 11, 12 (which stop
/// at the bark).
void place_in_base(Detection& detection, const laser::Segment& segment, const laser::Scan& scan,
                   bool is_trunk, const Rig& rig);

}  // namespace orchard::detection
