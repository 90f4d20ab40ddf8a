// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"

namespace orchard::mapping {

/// derived: Max range at which beams are evidence [m]; beyond it they are too sparse for a trunk.
inline constexpr double kBeamReach_m = 8.0;

/// What the beams of a scan show at a position.
enum class FreeSpaceEvidence {
  kUnknown,        ///< occluded, out of range, or too few beams
  kReturns,        ///< a beam returned from there, from any object
  kPassesThrough,  ///< all beams across the object and most across its uncertainty pass
};

/// Answer of FreeSpace::at().
struct FreeSpaceAnswer {
  FreeSpaceEvidence evidence = FreeSpaceEvidence::kUnknown;
  int num_across = 0;  ///< beams across the object's own width; kPassesThrough only
};

/// Whether what was seen at a place stands higher than the ground may be there; the more certain is
/// the larger.
enum class Clearance : std::uint8_t {
  kUntold,  ///< nothing is known of the ground
  kLow,     ///< the scan's plane was so low that the ground may have been seen
  kClear,
};

/// What the scans of a drive show at a passage between two objects.
enum class Passage {
  kUnknown,  ///< hardly in view
  kShut,     ///< beams end in it too often for it to be free
  kOpen,     ///< beams mostly pass between the objects, or the robot drove there
};

/// Beams of a scan towards a passage between two objects. Beams that end before it or soon after it
/// count neither way.
struct PassageBeams {
  int num_within = 0;  ///< end in it
  int num_through = 0;
};

/// Free-space evidence of one scan: tells whether its beams return from a position or pass through
/// it. Compact: one byte per beam.
class FreeSpace {
 public:
  /// Ignores beams in the blind sector and returns that the scanner marks as invalid. Ranges beyond
  /// kBeamReach_m from the laser are stored as "beyond" only.
  FreeSpace(const laser::Scan& scan, const laser::LaserConfig& laser,
            const laser::BlindSector& blind);

  std::int64_t utime() const { return utime_; }

  /// Whether the beams were sent one after the other.
  bool is_sweep() const { return beam_period_s_ > 0.0; }

  /// Sets the velocity of base during the sweep: x, y [m/s] and yaw [rad/s] in base. Default: 0.
  void set_velocity(const Eigen::Vector3d& velocity) { velocity_ = velocity; }

  /// Evidence at the position of a round object of width `width_m` at `p_base` (base at the scan's
  /// utime). `sd_m`: 1-sigma per axis of its total position uncertainty. A beam without return
  /// counts as passing up to half the scanner's range; beyond that, dark bark gives no return
  /// either.
  FreeSpaceAnswer at(const Eigen::Vector2d& p_base, double width_m, double sd_m) const;

  /// How high above the ground the scan's plane is at a position in base.
  Clearance clearance(const Eigen::Vector2d& p_base) const;

  /// Counts the beams through a passage and those that end in it. The passage is the line between
  /// two positions in base, widened by `half_depth_m` to each side; a beam through it goes on for
  /// `clear_m` at least.
  PassageBeams through(const Eigen::Vector2d& from_base, const Eigen::Vector2d& to_base,
                       double half_depth_m, double clear_m) const;

  /// Serializes all data to bytes, for unpack() of the same program. unpack() throws
  /// std::length_error when there are too few.
  std::vector<std::uint8_t> pack() const;
  static FreeSpace unpack(const std::vector<std::uint8_t>& bytes);

  std::size_t num_bytes() const { return sizeof(*this) + codes_.capacity(); }

 private:
  FreeSpace() = default;
  Eigen::Vector2d in_laser(const Eigen::Vector2d& p_base, double beam) const;
  double beam_of(const Eigen::Vector2d& p_laser) const;
  double bearing_of(double beam) const;
  bool is_beyond(std::uint8_t code, double range_m) const;

  std::int64_t utime_ = 0;
  laser::LaserConfig laser_;
  double bearing_middle_rad_ = 0.0;
  double bearing_step_rad_ = 0.0;
  double beam_period_s_ = 0.0;
  double no_return_m_ = 0.0;  ///< range up to which no return means passing
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  laser::OverGround over_ground_;
  std::vector<std::uint8_t> codes_;
};

}  // namespace orchard::mapping
