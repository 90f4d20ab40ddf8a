// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "text/finding.hpp"

namespace orchard::laser {

/// Measures the noise of a range relative to what the rig states, on smooth surfaces: over four
/// neighbouring beams a surface is a parabola, and what remains is noise.
///
/// Grass and leaves are rough, so the smoothest quarter of all surfaces counts. An error common to
/// neighbouring beams is not seen.
class RangeNoise {
 public:
  RangeNoise(const LaserConfig& laser, const BlindSector& blind, double range_max_m, double jump_m)
      : laser_(laser), blind_(blind), range_max_m_(range_max_m), jump_m_(jump_m) {}

  /// Takes a scan; one in kScanStep is used, until there are enough surfaces.
  void add(const Scan& scan);

  /// The noise over LaserConfig::range_sd_at; none for too few surfaces.
  std::optional<double> ratio() const;

  /// That the noise is at least twice as large as stated.
  std::optional<Finding> finding() const;

 private:
  void add_surface(const Scan& scan, std::size_t first, std::size_t end);

  LaserConfig laser_;
  BlindSector blind_;
  double range_max_m_;
  double jump_m_;
  int num_scans_ = 0;
  std::vector<double> ratios_;  ///< of each surface
};

}  // namespace orchard::laser
