// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "detection/detection.hpp"
#include "detection/motion.hpp"
#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "vision/image.hpp"

namespace orchard::detection {

/// What a scan and its picture show.
struct DetectResult {
  Detections detections;        ///< seq is left 0: the sender's
  bool image_unusable = false;  ///< needed, but did not decode or of another size
};

/// The paper's detector: segment, width, project, colour, edges, fuse. `image` may be null.
///
/// An object that the laser rejects is an OBJECT whatever the camera sees. A candidate that the
/// camera does not see in full, or of which something nearer hides a side, is UNSEEN; its roc_tree
/// stays 0. Of a rig without a camera roc_tree is roc_laser. A pure function; only the windows of
/// the picture are decoded. Source: Shalal et al. 2013, section 4 and figure 4.
/// `motion` of base about the picture's time, where known, moves each object's points from their
/// beams' time to the picture's.
DetectResult detect(const laser::Scan& scan, const vision::Image* image, const Rig& rig,
                    const std::optional<Motion>& motion = std::nullopt);

}  // namespace orchard::detection
