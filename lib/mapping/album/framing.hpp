// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "detection/motion.hpp"
#include "detection/rig.hpp"
#include "mapping/album/photograph.hpp"
#include "vision/picture_reader.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::mapping {

/// Where a subject stands in a picture.
struct Framing {
  vision::PixelRect frame;  ///< the part to cut out: the subject's axis is in its middle
  vision::PixelRect trunk;  ///< where its surface is looked at for sharpness
  double px_per_m = 0.0;
  double fraction = 1.0;   ///< how much of the wanted surroundings is in the picture, in (0, 1]
  bool is_hidden = false;  ///< something nearer hides a part of it
};

/// The framings of all subjects of a scan in a picture exposed `dt_s` after the scan, while base
/// moved as `motion` says; empty frames for those that are not in it, or too small, or wholly
/// behind a nearer one as the camera sees it.
std::vector<Framing> frame_subjects(const std::vector<Subject>& subjects, const detection::Rig& rig,
                                    const detection::Motion& motion, double dt_s);

/// How much a framing shows of its subject: details per metre of its surface (sharpness x pixels
/// per metre), less what is over- or underexposed, cut off or hidden. 0: nothing.
double worth(const Framing& framing, vision::PictureReader& picture);

/// The frame as a JPEG of at most kPhotoWidthMax_px columns; empty where it does not decode.
std::vector<std::uint8_t> cut_out(const Framing& framing, vision::PictureReader& picture);

inline constexpr int kPhotoWidthMax_px = 240;

}  // namespace orchard::mapping
