// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "pose/measurements.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/sensor/receiver_sky.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// A GNSS receiver on a driving robot with all effects of section `simulation.gnss`. Canopy covers
/// the same alley segments on every lap.
class SatelliteReceiver {
 public:
  SatelliteReceiver() = default;
  SatelliteReceiver(std::uint64_t seed, const SimulationConfig& config);

  /// Fix `index`, due at a time of the run [s], with the robot on `path`; none without sky view.
  /// Leaves utime and seq 0.
  std::optional<pose::Gnss> fix(const DrivePath& path, std::int64_t index, double time_s) const;

 private:
  bool under_canopy(double x_m, double y_m) const;

  std::uint64_t seed_ = 0;
  ReceiverConfig config_;
  MotionConfig motion_;
  OrchardConfig orchard_;
  ReceiverSky sky_;
};

}  // namespace orchard::simulation
