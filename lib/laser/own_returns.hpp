// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "laser/blind_sector.hpp"
#include "laser/scan.hpp"

namespace orchard::laser {

/// Which beams count, and how far apart two of their ranges are two things.
struct OwnReturnsConfig {
  double range_min_m = 0.0;  ///< nearer returns are hidden already
  double range_max_m = 0.0;  ///< farther ones are not used
  int min_beams = 1;         ///< fewer side by side are no object
  double range_sd_m = 0.01;  ///< 1-sigma of a range, the part that does not grow
  double range_sd_fraction = 0.0;
  BlindSector blind;  ///< hidden already
};

/// What of a scan travels with the robot.
struct OwnReturn {
  double reach_m = 0.0;  ///< it is nearer than this, and hardly anything else ever is
  BlindSector sector;    ///< the narrowest that hides it, and what was hidden before
};

/// Finds what travels with the robot: its own body, a mast, a load, who walks behind it.
///
/// The drive itself shows how near the world comes: in most directions nothing is ever nearer than
/// some range. A direction in which something is, more often than not, shows what came along. Only
/// scans of which most beams have changed since the last one used count: the robot has moved.
class OwnReturns {
 public:
  explicit OwnReturns(const OwnReturnsConfig& config) : config_(config) {}

  /// A scan with other beams than the last one begins anew.
  void add(const Scan& scan);

  /// None until enough scans were used.
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
  int num_scans_ = 0;             ///< used
  std::vector<float> last_m_;     ///< ranges of the last of them; 0 = no return
  std::vector<int> num_returns_;  ///< per beam and bin of range
};

}  // namespace orchard::laser
