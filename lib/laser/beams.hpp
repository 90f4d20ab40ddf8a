// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "laser/scan.hpp"
#include "laser/segmentation_config.hpp"

namespace orchard::laser {

/// Unit direction: cosine and sine of a bearing.
struct Direction {
  double c = 1.0;
  double s = 0.0;
};

/// The beams of one scan with validated ranges, in the order in which segmentation visits them. A
/// 360 degree scan starts at a gap, so that no object lies across the seam.
///
/// Positions run from 0 to size() - 1. Positions outside wrap around in a 360 degree scan; in any
/// other scan they are beams without return.
class Beams {
 public:
  Beams(const Scan& scan, const SegmentationConfig& config);

  std::ptrdiff_t size() const { return size_; }
  double step_rad() const { return step_rad_; }    ///< angle between neighbouring beams, > 0
  const Direction& step() const { return step_; }  ///< the same, as a direction

  /// Index into the scan's ranges_m of a position in [-size(), 2 size()).
  std::size_t index(std::ptrdiff_t i) const {
    const std::ptrdiff_t shifted = i + start_;
    return static_cast<std::size_t>(shifted >= size_ ? shifted - size_
                                    : shifted < 0    ? shifted + size_
                                                     : shifted);
  }
  /// The validated range [m] at a position in [0, size()); 0 = no return.
  float range_m(std::ptrdiff_t i) const { return ranges_m_[index(i)]; }
  /// As range_m(), also for positions beyond the ends (see the class comment).
  float range_around_m(std::ptrdiff_t i) const {
    if (!is_turn_ && (i < 0 || i >= size_)) return 0.0f;
    return ranges_m_[index(around(i))];
  }
  /// Whether the laser cannot see at this position: blind sector, end of the scan, or a range below
  /// the minimum or just beyond the maximum.
  bool blocked(std::ptrdiff_t i) const {
    if (!is_turn_ && (i < 0 || i >= size_)) return true;
    return blocked_[index(around(i))] != 0;
  }
  /// Whether a beam hit a reflector; false if reflectors are ignored.
  bool bright(std::ptrdiff_t i) const { return has_bright_ && bright_[index(i)] != 0; }
  bool has_bright() const { return has_bright_; }
  /// Range step that separates two objects at this range [m].
  double jump_m(double range_m) const { return config_.jump_m + config_.jump_fraction * range_m; }
  /// Whether two neighbouring ranges belong to one object.
  bool joined(double a_m, double b_m) const {
    return a_m > 0.0 && b_m > 0.0 &&
           (a_m < b_m ? b_m - a_m <= jump_m(a_m) : a_m - b_m <= jump_m(b_m));
  }

 private:
  /// Wraps a position at or above -size() of a 360 degree scan into [0, size()).
  std::ptrdiff_t around(std::ptrdiff_t i) const {
    return i >= 0 && i < size_ ? i : (i + size_) % size_;  // division is slow and rarely needed
  }
  void validate(const Scan& scan);
  void find_bright(const Scan& scan);
  std::ptrdiff_t first_gap() const;

  const SegmentationConfig& config_;
  std::ptrdiff_t size_;
  double step_rad_;
  Direction step_;
  std::ptrdiff_t start_ = 0;
  bool is_turn_ = false;
  std::vector<float> ranges_m_;
  std::vector<std::uint8_t> blocked_;
  std::vector<std::uint8_t> bright_;
  bool has_bright_ = false;
};

}  // namespace orchard::laser
