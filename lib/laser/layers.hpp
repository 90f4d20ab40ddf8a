// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "laser/scan.hpp"

namespace orchard::laser {

/// physical: the height at which growers measure a trunk: a foot, clear of the graft union.
inline constexpr double kTrunkHeight_m = 0.3;

/// The layers of a scanner and the horizontal plane that they are joined in.
struct LayerGeometry {
  std::vector<double> elevations_rad;  ///< of each layer above the horizontal; at most 32
  double scanner_height_m = 0.0;       ///< of the scanner's middle above the ground
  double plane_height_m = kTrunkHeight_m;
};

/// Which layer tells of the plane at which distance. Layers are cones, so each distance has one
/// layer whose height is nearest to the plane's, among those at least two thirds as high: lower
/// ones meet grass. Nearer than any layer comes down to the plane, it is the lowest layer.
class LayerPlan {
 public:
  explicit LayerPlan(const LayerGeometry& geometry);

  /// derived: there layers 2 degrees apart are a metre apart, and a return tells of no height.
  static constexpr double kReach_m = 30.0;

  /// What a shot that returns from a horizontal distance says of the plane: that something stands
  /// in the layer's own distances, that these are empty, or nothing, as it ended before them.
  enum class Says { kNothing, kReturn, kPast };
  Says of(std::size_t layer, double level_m) const {
    const Interval& own = own_[layer];
    if (level_m > own.to_m) return own.is_empty() ? Says::kNothing : Says::kPast;
    return level_m >= own.from_m ? Says::kReturn : Says::kNothing;
  }

  /// Whether any distance is a layer's own.
  bool uses(std::size_t layer) const { return !own_[layer].is_empty(); }

  /// The layers, one bit each, that must pass where nothing stands up to half of kReach_m, the
  /// distance that a beam without a return speaks for (mapping/free_space.hpp).
  std::uint32_t needed() const { return needed_; }

 private:
  struct Interval {
    double from_m = 1.0, to_m = 0.0;
    bool is_empty() const { return from_m > to_m; }
  };
  std::vector<Interval> own_;
  std::uint32_t needed_ = 0;
};

/// One turn of a scanner with layers, joined to a scan of the plane: each beam is the nearest
/// return of a layer in its own distances.
class JoinedTurn {
 public:
  JoinedTurn(const LayerPlan& plan, std::size_t num_beams) : plan_(&plan), beams_(num_beams) {}

  /// Adds a shot: the distance of its return along the horizontal [m], 0 for none.
  void add(std::size_t beam, std::size_t layer, float level_m, std::uint8_t intensity);

  std::size_t num_beams() const { return beams_.size(); }

  /// Sets ranges, intensities and the reach of a scan. A beam is without a return (0) if all needed
  /// layers passed; else it is not measured (NaN).
  void write_to(Scan& scan) const;

 private:
  struct Beam {
    float level_m = 0.0f;
    std::uint8_t intensity = 0;
    std::uint32_t passed = 0;  ///< one bit per layer
  };
  const LayerPlan* plan_;
  std::vector<Beam> beams_;
};

}  // namespace orchard::laser
