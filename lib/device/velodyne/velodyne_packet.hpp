// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace orchard::device {

/// A data packet of a VLP-16 by its user manual (63-9243, chapter 9): the payload of one datagram,
/// 12 blocks of two firings of all 16 lasers; with two returns, 6 pairs of blocks.
class VelodynePacket {
 public:
  static constexpr std::size_t kNumBytes = 1206;
  static constexpr std::size_t kNumBlocks = 12;
  static constexpr std::size_t kNumLasers = 16;
  static constexpr int kTurn_cdeg = 36000;
  /// physical: time between two lasers and two firings, and the one over which a block stands.
  static constexpr double kLaser_us = 2.304;
  static constexpr double kFiring_us = 55.296;
  static constexpr double kBlock_us = 2 * kFiring_us;
  /// physical: unit of a range [m].
  static constexpr float kRangeUnit_m = 0.002f;

  /// Which returns the scanner sends.
  enum class Returns : std::uint8_t { kStrongest = 0x37, kLast = 0x38, kDual = 0x39 };

  struct Shot {
    std::uint16_t range = 0;  ///< in kRangeUnit_m; 0: no return
    std::uint8_t reflectivity = 0;
  };

  /// Checks length, flags, product, mode, clock and rotation. Otherwise the reason, for the user.
  static std::variant<VelodynePacket, std::string> parse(std::string_view bytes);

  Returns returns() const { return returns_; }

  /// Time of the first shot after the full hour or the start [us], below 3600 s.
  std::uint32_t stamp_us() const { return stamp_us_; }

  /// Number of pairs of firings, one after the other.
  std::size_t num_columns() const { return returns_ == Returns::kDual ? 6 : 12; }
  double duration_us() const { return kBlock_us * static_cast<double>(num_columns()); }

  /// Azimuth of the first shot of a pair of firings, clockwise [0.01 degree].
  int azimuth_cdeg(std::size_t column) const { return azimuth_of(block_of(column)); }

  /// By how much the head turns per microsecond [0.01 degree].
  double rate_cdeg_per_us() const { return rate_cdeg_per_us_; }

  /// A shot: `firing` 0 or 1 of the pair. Of two returns it is the last, the one whose place is
  /// certain (blocks of odd number hold the strongest or the second strongest): grass and leaves
  /// let a part of the beam through, a trunk does not.
  Shot shot(std::size_t column, std::size_t firing, std::size_t laser) const;

 private:
  std::size_t block_of(std::size_t column) const {
    return returns_ == Returns::kDual ? 2 * column : column;
  }
  int azimuth_of(std::size_t block) const;
  std::string find_fault();

  std::array<std::uint8_t, kNumBytes> bytes_;
  std::uint32_t stamp_us_ = 0;
  Returns returns_ = Returns::kStrongest;
  double rate_cdeg_per_us_ = 0.0;
};

/// Elevation of a laser [rad].
double vlp16_elevation_rad(std::size_t laser);

}  // namespace orchard::device
