// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "detection/motion.hpp"
#include "detection/rig.hpp"
#include "mapping/album/photograph.hpp"
#include "vision/decode.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::mapping {

/// Location of a subject in an image.
struct Framing {
  vision::PixelRect frame;  ///< region to cut out, centred on the subject's axis
  vision::PixelRect trunk;  ///< region of its surface used for the sharpness
  double px_per_m = 0.0;
  double fraction = 1.0;   ///< fraction of the wanted frame inside the image, in (0, 1]
  bool is_hidden = false;  ///< partly hidden by a nearer object
};

/// Framings of all subjects of a scan in an image exposed `dt_s` after the scan, with `motion` of
/// base between. The frame is empty for subjects outside the image, too small, or with their axis
/// hidden by a nearer subject.
std::vector<Framing> frame_subjects(const std::vector<Subject>& subjects, const detection::Rig& rig,
                                    const detection::Motion& motion, double dt_s);

/// Quality of a framing: details per metre of the subject's surface (sharpness x pixels per metre),
/// reduced by over- and underexposure, cropping and occlusion. 0: unusable.
double quality(const Framing& framing, vision::PictureReader& picture);

/// The frame as a JPEG of at most kPhotoWidthMax_px columns; empty if the image cannot be decoded.
std::vector<std::uint8_t> cropped_jpeg(const Framing& framing, vision::PictureReader& picture);

inline constexpr int kPhotoWidthMax_px = 240;

}  // namespace orchard::mapping
