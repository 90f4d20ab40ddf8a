// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "laser/blind_sector.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"

namespace orchard::mapping {

/// Range within which beams are evidence [m]: farther ones are too sparse for a trunk.
inline constexpr double kBeamReach_m = 8.0;

/// What the beams of a scan say of a position.
enum class FreeSpaceEvidence {
  kUnknown,        ///< hidden, out of reach, or too few beams
  kReturns,        ///< something returned from there, whatever it is
  kPassesThrough,  ///< every beam across the thing, and nearly all across where it may be, goes on
};

struct FreeSpaceAnswer {
  FreeSpaceEvidence evidence = FreeSpaceEvidence::kUnknown;
  int num_across = 0;  ///< beams across the thing's own width; of kPassesThrough alone
};

/// Free-space evidence: the beams of one scan, kept small (a byte each), asked whether they return
/// from a position or pass through it.
class FreeSpace {
 public:
  /// Beams in the blind sector and returns that the scanner itself does not believe say nothing. Of
  /// what lies beyond kBeamReach_m from the laser only that it does is kept.
  FreeSpace(const laser::Scan& scan, const laser::LaserConfig& laser,
            const laser::BlindSector& blind);

  std::int64_t utime() const { return utime_; }

  /// Whether its beams were sent one after the other.
  bool is_sweep() const { return beam_period_s_ > 0.0; }

  /// How base moves during the sweep, per second: x, y [m/s] and yaw [rad/s] in base. Unset: not.
  void set_velocity(const Eigen::Vector3d& velocity) { velocity_ = velocity; }

  /// Of something round, `width_m` wide, at `p_base` as base was at the scan's utime. `sd_m`:
  /// 1-sigma per axis of all that is uncertain about its position. No return counts as going on up
  /// to half the scanner's range: beyond it, dark bark gives none either.
  FreeSpaceAnswer at(const Eigen::Vector2d& p_base, double width_m, double sd_m) const;

  /// All of it as bytes, for unpack() of the same program.
  std::vector<std::uint8_t> pack() const;
  static FreeSpace unpack(const std::vector<std::uint8_t>& bytes);

  std::size_t num_bytes() const { return sizeof(*this) + codes_.capacity(); }

 private:
  FreeSpace() = default;
  Eigen::Vector2d in_laser(const Eigen::Vector2d& p_base, double beam) const;
  double beam_of(const Eigen::Vector2d& p_laser) const;

  std::int64_t utime_ = 0;
  laser::LaserConfig laser_;
  double bearing_middle_rad_ = 0.0;
  double bearing_step_rad_ = 0.0;
  double beam_period_s_ = 0.0;
  double reach_m_ = 0.0;
  double sigmas_ = 0.0;
  double fraction_ = 0.0;
  double no_return_m_ = 0.0;  ///< up to which no return counts as going on
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  std::vector<std::uint8_t> codes_;
};

}  // namespace orchard::mapping
