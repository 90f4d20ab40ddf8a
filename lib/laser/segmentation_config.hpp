// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/blind_sector.hpp"

namespace orchard::laser {

/// Meaning of a reflector: an object with at least one beam of intensity reflectivity_min or more.
enum class ReflectorUse {
  kIgnored,  ///< nothing
  kOnly,     ///< trees carry reflectors: an object without one is not a tree
  kExclude,  ///< posts and other marks carry reflectors: an object with one is not a tree
};

/// Parameters of scan segmentation. Section `detector.segmentation`.
struct SegmentationConfig {
  double range_min_m = 0.05;          ///< nearer returns are the robot itself
  double range_max_m = 5.6;           ///< farther returns are not used
  double jump_m = 0.10;               ///< a range step of this size separates objects
  double jump_fraction = 0.02;        ///< plus this much per metre of range
  int min_beams = 2;                  ///< objects with fewer beams are not reported
  double width_max_m = 2.0;           ///< wider objects (walls, hedges) are not reported
  double blind_centre_rad = 0.0;      ///< middle of a sector in which the scanner sees the robot
  double blind_half_width_rad = 0.0;  ///< half the angle of the sector; 0 = no sector
  int merge_occluded_beams = 3;       ///< max width of the clutter that parts are merged across
  bool split_touching = true;         ///< split an object that two circles fit clearly better
  int min_beams_circle = 3;           ///< min beams for a circle fit; twice that with a hidden side
  ReflectorUse reflector = ReflectorUse::kIgnored;
  double reflectivity_min = 0.0;  ///< min intensity of a reflector

  BlindSector blind_sector() const { return {blind_centre_rad, blind_half_width_rad}; }
};

template <class Visitor>
void describe(Visitor& v, SegmentationConfig& c) {
  v.number("range_min_m", c.range_min_m, 0, 100, "m", "nearer returns are the robot itself");
  v.number("range_max_m", c.range_max_m, 0.1, 500, "m", "farther returns are not used");
  v.number("jump_m", c.jump_m, 0.001, 10, "m", "range step that separates objects");
  v.expert().number("jump_fraction", c.jump_fraction, 0, 1, "1",
                    "growth of that step per metre of range");
  v.integer("min_beams", c.min_beams, 1, 1000, "beams", "fewest beams of an object");
  v.number("width_max_m", c.width_max_m, 0.05, 100, "m", "wider things are not reported");
  v.number("blind_centre_rad", c.blind_centre_rad, -6.2832, 6.2832, "rad",
           "laser frame: middle of a sector that shows the robot itself");
  v.number("blind_half_width_rad", c.blind_half_width_rad, 0, 3.1416, "rad",
           "half the angle of that sector; 0 for none");
  v.integer("merge_occluded_beams", c.merge_occluded_beams, 0, 20, "beams",
            "parts of an object that grass or a twig hides are merged over at most so many beams; "
            "0 = off");
  v.flag("split_touching", c.split_touching,
         "split what two circles fit clearly better than one: trunks that touch");
  v.expert().integer("min_beams_circle", c.min_beams_circle, 3, 1000, "beams",
                     "fewest beams to which a circle is fitted; twice that with a side hidden");
  v.choice("reflector", c.reflector, {"ignored", "only", "exclude"},
           "reflectors mark nothing | the trees, and only they can be trees | what is no tree");
  v.number("reflectivity_min", c.reflectivity_min, 0, 1e9, "as the scanner's intensities",
           "one beam this bright makes an object a reflector");
  v.check(c.reflector == ReflectorUse::kIgnored || c.reflectivity_min > 0.0, "reflectivity_min",
          "must be above 0 when reflector is not ignored; `orchard echo SCAN` shows intensities");
  v.check(c.range_min_m < c.range_max_m, "range_min_m", "must be below range_max_m");
}

}  // namespace orchard::laser
