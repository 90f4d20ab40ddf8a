// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/ground_ray.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::simulation {
namespace {

/// physical: area of blades over area of ground, mean of grasslands (Asner, Scurlock, Hicke 2003).
constexpr double kLeafArea = 1.7;

/// physical: blades of all directions alike show half of their area to any side (Ross 1981).
constexpr double kSeenFraction = 0.5;

// physical: reflectance near 905 nm of dry soil and of green leaves (typical of the spectra of USGS
// Data Series 1035); of leaves in all directions half remains, the mean cosine of incidence.
constexpr double kSoil = 0.3;
constexpr double kGrass = 0.45 * 0.5;

/// derived: a quarter of the shortest bumps, between which a beam that grazes them may pass.
constexpr double kStepMin_m = 0.08;

/// derived: changes of a beam's height below this per metre are none within the range of scanners.
constexpr double kLevel = 1e-6;

constexpr double kExact_m = 1e-4;  ///< derived: a tenth of the finest resolution of scanners

/// derived: within it the shortest bumps are straight to a micrometre.
constexpr double kStraight_m = 0.01;

/// A beam above the ground.
class Descent {
 public:
  Descent(const Terrain& terrain, const Eigen::Vector3d& from, const Eigen::Vector3d& towards)
      : terrain_(terrain), from_(from), towards_(towards) {}

  double height_m(double range_m) const {
    const Eigen::Vector3d p = from_ + range_m * towards_;
    return p.z() - terrain_.height_m(p.x(), p.y());
  }

  /// Height above what bumps hardly exceed, for beams that are not yet among them.
  double clear_m(double range_m) const {
    const Eigen::Vector3d p = from_ + range_m * towards_;
    return p.z() - terrain_.graded_m(p.x(), p.y()) - terrain_.bump_max_m();
  }

  /// Height lost or gained per metre, hardly exceeded: above the bumps, and among them.
  double clear_rate() const {
    return std::abs(towards_.z() - terrain_.slope().dot(towards_.head<2>())) +
           terrain_.bank_steepness() * towards_.head<2>().norm() + kLevel;
  }
  double rate() const {
    return clear_rate() + terrain_.bump_steepness() * towards_.head<2>().norm();
  }

  /// The range at which the beam meets the ground, between one above and one below it.
  double ground_m(double above_m, double below_m) const {
    double high_m = height_m(above_m), low_m = height_m(below_m);
    while (below_m - above_m > kStraight_m) {
      const double middle_m = 0.5 * (above_m + below_m), between_m = height_m(middle_m);
      (between_m > 0.0 ? above_m : below_m) = middle_m;
      (between_m > 0.0 ? high_m : low_m) = between_m;
    }
    return above_m + (below_m - above_m) * high_m / (high_m - low_m);
  }

  double cosine(double range_m) const {
    const Eigen::Vector3d p = from_ + range_m * towards_;
    const Eigen::Vector2d g = terrain_.gradient(p.x(), p.y());
    const Eigen::Vector3d normal = Eigen::Vector3d(-g.x(), -g.y(), 1.0).normalized();
    return std::abs(normal.dot(towards_));
  }

 private:
  const Terrain& terrain_;
  const Eigen::Vector3d& from_;
  const Eigen::Vector3d& towards_;
};

/// Part of a step within a layer, of heights at its ends.
struct Within {
  double begin = 0.0, end = 0.0;  ///< fractions of the step
};

Within within_layer(double height_m, double next_m, double layer_m) {
  const double cross = (layer_m - height_m) / (next_m - height_m);
  if (height_m < layer_m) return {0.0, next_m < layer_m ? 1.0 : cross};
  return next_m < layer_m ? Within{cross, 1.0} : Within{};
}

}  // namespace

Hit meet_ground(const Terrain& terrain, double grass_height_m, const Eigen::Vector3d& from,
                const Eigen::Vector3d& towards, double range_max_m, double uniform) {
  const Descent beam(terrain, from, towards);
  // Beer-Lambert: 1 / (seen area of blades per volume) is the mean way through grass.
  double left_m = -std::log(uniform) * grass_height_m / (kSeenFraction * kLeafArea);
  double range_m = 0.0;
  while (range_m < range_max_m) {
    const double clear_m = beam.clear_m(range_m) - grass_height_m;
    if (clear_m > 0.0) {
      range_m += std::max(kExact_m, clear_m / beam.clear_rate());
      continue;
    }
    const double height_m = beam.height_m(range_m);
    if (height_m <= 0.0) return {range_m, -1, kSoil * beam.cosine(range_m)};
    // Above the grass nothing can be met before its tops are; in it, before the ground is.
    const double free_m = height_m > grass_height_m ? height_m - grass_height_m : height_m;
    const double step_m = std::max(kStepMin_m, free_m / beam.rate());
    const double next_m = beam.height_m(range_m + step_m);
    const double ground_m = next_m > 0.0 ? kNoHit : beam.ground_m(range_m, range_m + step_m);
    const Within grass = within_layer(height_m, next_m, grass_height_m);
    const double in_grass_m = (grass.end - grass.begin) * step_m;
    if (grass_height_m > 0.0 && in_grass_m > left_m) {
      const double at_m = range_m + grass.begin * step_m + left_m;
      if (at_m < ground_m) return {at_m, -1, kGrass};
    }
    if (ground_m != kNoHit) return {ground_m, -1, kSoil * beam.cosine(ground_m)};
    left_m -= in_grass_m;
    range_m += step_m;
  }
  return {};
}

}  // namespace orchard::simulation
