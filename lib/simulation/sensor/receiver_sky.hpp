// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulation/random.hpp"
#include "simulation/scene/drive_config.hpp"

namespace orchard::simulation {

/// What the sky does to a receiver in the course of time: gaps and bursts of fixes, an error that
/// wanders, reflected signals for a while. Drawn once for a day, which then repeats.
class ReceiverSky {
 public:
  ReceiverSky() = default;
  ReceiverSky(std::uint64_t seed, const SkyConfig& config);

  /// Whether fixes come at a time of the run [s].
  bool is_open(double time_s) const;

  /// East and north by which a fix is off, besides its own noise [m].
  Eigen::Vector2d error_m(double time_s) const;

  /// Whether signals are reflected then.
  bool is_reflected(double time_s) const;

  /// Standard deviation of the wandering error per axis [m].
  double wander_sd_m() const { return config_.wander_sd_m; }

 private:
  struct Episode {
    double begin_s;
    double end_s;
    Eigen::Vector2d offset_m;
  };

  static const Episode* at(const std::vector<Episode>& episodes, double time_s);

  SkyConfig config_;
  std::vector<Episode> gaps_;
  std::vector<Episode> pauses_;
  std::vector<Episode> reflections_;
  std::vector<Eigen::Vector2d> wander_;  ///< at equal steps, in standard deviations
};

}  // namespace orchard::simulation
