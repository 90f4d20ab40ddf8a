// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"

namespace orchard::laser {

/// Limits of the returns in use, and the range noise.
struct OwnReturnsConfig {
  double range_min_m = 0.0;  ///< nearer returns are ignored by segmentation already
  double range_max_m = 0.0;  ///< farther returns are not used
  int min_beams = 1;         ///< min number of neighbouring beams of an object
  double range_sd_m = 0.01;  ///< 1-sigma of a range, constant part
  double range_sd_fraction = 0.0;
  BlindSector blind;  ///< sector that is configured already
};

/// Returns from an object that travels with the robot.
struct OwnReturn {
  double reach_m = 0.0;  ///< the object is nearer than this; other objects hardly ever are
  BlindSector sector;    ///< narrowest sector that contains it and the configured blind sector
};

/// Finds objects that travel with the robot: its own body, a mast, a load, a person walking behind.
///
/// The method learns the robot's clearance: the range below which most directions hardly ever have
/// a return. Directions with nearer returns in at least half of the scans show an object that
/// travels along. A scan is used only if most beams have changed since the last scan used, so that
/// the robot has moved.
class OwnReturns {
 public:
  explicit OwnReturns(const OwnReturnsConfig& config) : config_(config) {}

  /// Adds a scan. A change of the number or bearings of the beams restarts the statistics.
  void add(const Scan& scan);

  /// The object found, if any. None until enough scans were used.
  std::optional<OwnReturn> found() const;

 private:
  bool has_moved(const Scan& scan) const;
  double bearing_rad(std::size_t beam) const;
  std::vector<double> fractions_within(std::size_t num_bins) const;
  std::optional<std::size_t> clear_bins() const;
  BlindSector hiding(const std::vector<double>& fractions) const;

  OwnReturnsConfig config_;
  double bearing_min_rad_ = 0.0;
  double bearing_step_rad_ = 0.0;
  int num_scans_ = 0;             ///< scans used
  std::vector<float> last_m_;     ///< ranges of the last scan used; 0 = no return
  std::vector<int> num_returns_;  ///< by beam and range bin
};

}  // namespace orchard::laser
