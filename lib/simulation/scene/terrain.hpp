// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulation/scene/scene_config.hpp"

namespace orchard::simulation {

/// Height of the ground over the map: a slope, terraces, and bumps with the spectrum of ISO 8608.
class Terrain {
 public:
  /// Level ground at height 0.
  Terrain() = default;

  Terrain(std::uint64_t seed, const TerrainConfig& config);

  /// Height of the ground at a place of the map [m].
  double height_m(double x_m, double y_m) const { return graded_m(x_m, y_m) + bump_m(x_m, y_m); }

  /// Gradient of the height at a place of the map, along x and y [m/m].
  Eigen::Vector2d gradient(double x_m, double y_m) const;

  /// Height of slope and terraces, without the bumps on them [m]; cheap.
  double graded_m(double x_m, double y_m) const;

  /// Gradient of the slope, and how steep terraces, and bumps that hardly any place exceeds, are
  /// about it [m/m].
  const Eigen::Vector2d& slope() const { return slope_; }
  double bank_steepness() const { return bank_steepness_; }
  double bump_steepness() const { return bump_steepness_; }

  /// Height of bumps that hardly any place exceeds [m].
  double bump_max_m() const { return bump_max_m_; }

 private:
  /// A sinusoid of the bumps, `amplitude_m sin(k . (x, y) + phase_rad)`.
  struct Wave {
    double kx_radpm, ky_radpm;
    double amplitude_m;
    double phase_rad;
  };

  /// A place across the terraces.
  struct Bank {
    double terrace;   ///< number of the terrace that ends in the bank
    double fraction;  ///< of the bank that is passed, 0 before it and 1 behind
  };

  Bank bank_at(double x_m) const;
  double bump_m(double x_m, double y_m) const;
  void add_bumps(std::uint64_t seed, double roughness_m3);

  Eigen::Vector2d slope_ = Eigen::Vector2d::Zero();
  double terrace_height_m_ = 0.0;
  double terrace_width_m_ = 1.0;
  double bank_m_ = 0.0;  ///< extent of a bank along x
  std::vector<Wave> waves_;
  double bank_steepness_ = 0.0;
  double bump_steepness_ = 0.0;
  double bump_max_m_ = 0.0;
};

}  // namespace orchard::simulation
