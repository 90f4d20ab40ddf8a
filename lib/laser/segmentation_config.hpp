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
  double range_min_m = 0.05;
  double range_max_m = 5.6;
  double jump_m = 0.10;
  double jump_fraction = 0.02;
  int min_beams = 2;
  double width_max_m = 2.0;
  double blind_centre_rad = 0.0;
  double blind_half_width_rad = 0.0;
  bool split_touching = true;
  int min_beams_circle = 3;
  ReflectorUse reflector = ReflectorUse::kIgnored;
  double reflectivity_min = 0.0;

  BlindSector blind_sector() const { return {blind_centre_rad, blind_half_width_rad}; }
};

template <class Visitor>
void describe(Visitor& v, SegmentationConfig& c) {
  v.number("range_min_m", c.range_min_m, 0, 100, "m",
           "nearer returns are ignored (the robot itself)");
  v.number("range_max_m", c.range_max_m, 0.1, 500, "m",
           "farther returns are ignored; larger finds more distant trunks with fewer beams");
  v.number("jump_m", c.jump_m, 0.001, 10, "m",
           "min range step between two objects; larger merges neighbours");
  v.expert().number("jump_fraction", c.jump_fraction, 0, 1, "1",
                    "growth of jump_m per metre of range");
  v.integer("min_beams", c.min_beams, 1, 1000, "beams",
            "min beams of an object; larger drops thin and distant objects");
  v.number("width_max_m", c.width_max_m, 0.05, 100, "m",
           "max width of an object; wider ones (walls, hedges) are not reported");
  v.number("blind_centre_rad", c.blind_centre_rad, -6.2832, 6.2832, "rad",
           "middle of the sector in which the scanner sees the robot itself, in the laser frame");
  v.number("blind_half_width_rad", c.blind_half_width_rad, 0, 3.1416, "rad",
           "half the angle of that sector; 0 = no such sector");
  v.expert().flag("split_touching", c.split_touching,
                  "split an object that two circles fit clearly better than one (touching trunks)");
  v.expert().integer("min_beams_circle", c.min_beams_circle, 3, 1000, "beams",
                     "min beams for a circle fit; twice as many with a hidden side");
  v.choice("reflector", c.reflector, {"ignored", "only", "exclude"},
           "meaning of reflectors: none | only objects with a reflector can be trees | objects "
           "with a reflector are not trees");
  v.number("reflectivity_min", c.reflectivity_min, 0, 1e9, "intensity units of the scanner",
           "min intensity of a beam on a reflector; read intensities with `orchard echo SCAN`");
  v.check(c.reflector == ReflectorUse::kIgnored || c.reflectivity_min > 0.0, "reflectivity_min",
          "must be above 0 if reflector is not ignored; `orchard echo SCAN` shows the intensities");
  v.check(c.range_min_m < c.range_max_m, "range_min_m", "must be below range_max_m");
}

}  // namespace orchard::laser
