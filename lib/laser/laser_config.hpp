// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::laser {

/// The sector of bearings (laser frame) in which the scanner sees its own robot.
struct BlindSector {
  double centre_rad = 0.0;
  double half_width_rad = 0.0;  ///< 0 = no such sector

  bool contains(double bearing_rad) const {
    return half_width_rad > 0.0 &&
           std::abs(geometry::wrap_angle_rad(bearing_rad - centre_rad)) <= half_width_rad;
  }
};

/// Extrinsics and noise model of the laser. Section `laser`.
struct LaserConfig {
  double mount_x_m = 0.0;
  double mount_y_m = 0.0;
  double mount_yaw_rad = 0.0;
  double height_m = 0.0;  ///< of the scan plane above the ground; 0 = scans are not levelled
  double range_sd_m = 0.010;
  double range_sd_fraction = 0.01;
  /// 1-sigma per metre of range of the error common to all beams of one object.
  double target_sd_fraction = 0.0;
  /// Width of the laser spot at the scanner, and its growth per metre of range. An object also
  /// returns a beam that meets it with half its spot, so measured widths are too large by the spot.
  double spot_m = 0.0;
  double spot_rad = 0.0;

  /// 1-sigma of one range.
  double range_sd_at(double range_m) const {
    return std::hypot(range_sd_m, range_sd_fraction * range_m);
  }
  /// Width of the spot at a range: the amount by which a measured width is too large.
  double spot_at(double range_m) const { return spot_m + spot_rad * range_m; }
};

/// A second scanner; both contribute to one map. Section `laser_rear`.
struct RearLaserConfig : LaserConfig {
  bool enabled = false;
};

template <class Visitor>
void describe(Visitor& v, LaserConfig& c) {
  v.number("mount_x_m", c.mount_x_m, -10, 10, "m",
           "x of the laser in base (forward), measured with a ruler");
  v.number("mount_y_m", c.mount_y_m, -10, 10, "m",
           "y of the laser in base (left), measured with a ruler");
  v.number("mount_yaw_rad", c.mount_yaw_rad, -6.2832, 6.2832, "rad",
           "yaw of the laser in base, counter-clockwise; 0 = looks forward");
  v.number("height_m", c.height_m, 0, 5, "m",
           "height of the scan plane above the ground, for a robot with an IMU on slopes or bumps: "
           "its scans are levelled and the ground in them is left out; 0 = taken as level");
  v.number("range_sd_m", c.range_sd_m, 0, 1, "m",
           "standard deviation of a range, constant part; from the data sheet");
  v.number("range_sd_fraction", c.range_sd_fraction, 0, 0.2, "1",
           "standard deviation of a range per metre of range; from the data sheet");
  v.expert().number(
      "target_sd_fraction", c.target_sd_fraction, 0, 0.2, "1",
      "standard deviation per metre of range of the error common to all beams of an object");
  v.expert().number("spot_m", c.spot_m, 0, 0.2, "m",
                    "width of the laser spot at the scanner; from the data sheet, or the excess of "
                    "measured widths at short range");
  v.expert().number("spot_rad", c.spot_rad, 0, 0.05, "rad",
                    "divergence of the beam, subtracted from widths; from the data sheet or "
                    "`orchard calibrate trunks`");
}

template <class Visitor>
void describe(Visitor& v, RearLaserConfig& c) {
  v.flag("enabled", c.enabled, "true for a robot with a second scanner (SCAN.rear)");
  describe(v, static_cast<LaserConfig&>(c));
}

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

/// derived: roc_laser (eq. 10) at three standard deviations: exp(-4.5).
inline constexpr double kThreeSigmaRoc = 0.011108996538242306;

enum class WidthMode {
  kCompensated,  ///< unbiased: adds the beam step that the chord loses on average
  kPaper,        ///< the chord of Shalal et al. 2013, eq. 8 (with its root)
};

/// Model of trunk widths. Section `detector.width`; calibrated from twenty trees.
struct WidthConfig {
  WidthMode mode = WidthMode::kCompensated;
  double mean_m = 0.090;
  double sd_m = 0.010;
  /// physical: lower limit of sigma; trunks are not round.
  static constexpr double kSdFloor_m = 0.006;
  double sd_per_beam_step = 0.4;
};

template <class Visitor>
void describe(Visitor& v, WidthConfig& c) {
  v.expert().choice(
      "mode", c.mode, {"compensated", "paper"},
      "width from the beams of an object: unbiased, or the chord of the paper (eq. 8)");
  v.number("mean_m", c.mean_m, 0.005, 5, "m",
           "mean trunk width at the height of the scanner (mu of eq. 9); from `orchard calibrate "
           "trunks` or a calliper");
  v.number("sd_m", c.sd_m, 0, 2, "m",
           "standard deviation of trunk widths (sigma of eq. 9); from `orchard calibrate trunks`");
  v.expert().number("sd_per_beam_step", c.sd_per_beam_step, 0, 20, "1",
                    "growth of the standard deviation with range, in units of range x beam step");
}

}  // namespace orchard::laser
