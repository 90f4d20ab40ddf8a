// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulation/random.hpp"
#include "simulation/scene/drive_config.hpp"

namespace orchard::simulation {

/// Time-correlated effects on a GNSS receiver: gaps and bursts of fixes, a slowly varying error,
/// multipath. Drawn once for a day, which then repeats.
class ReceiverSky {
 public:
  ReceiverSky() = default;
  ReceiverSky(std::uint64_t seed, const SkyConfig& config);

  /// True if fixes are available at a time of the run [s].
  bool is_open(double time_s) const;

  /// Error of a fix, east and north, without its own noise [m].
  Eigen::Vector2d error_m(double time_s) const;

  /// True during multipath.
  bool is_reflected(double time_s) const;

  /// Standard deviation of the slowly varying error per axis [m].
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
