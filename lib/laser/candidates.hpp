// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "laser/circle_fit.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "laser/tuning.hpp"

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

/// A segment candidate: the beams of one object, as positions in Beams.
struct Candidate {
  std::ptrdiff_t first = 0;
  std::ptrdiff_t last = 0;
  int num_beams = 0;            ///< number of beams on the object
  bool is_bright = false;       ///< cut around a reflector
  bool touches_before = false;  ///< separated there from a touching object, not by a spike
  bool touches_after = false;
  bool hidden_before = false;  ///< continues there behind the touching object
  bool hidden_after = false;
};

/// Calls visit(position) for each beam on the object, in order. Skips beams without return and
/// single beams on a thin object in front.
template <class Visitor>
void for_each_beam(const Beams& beams, const Candidate& candidate, Visitor visit) {
  for (std::ptrdiff_t i = candidate.first; i <= candidate.last; ++i) {
    const float range_m = beams.range_m(i);
    if (range_m <= 0.0f) continue;
    const bool alone = i > candidate.first && i < candidate.last &&
                       !beams.joined(range_m, beams.range_m(i - 1)) &&
                       !beams.joined(range_m, beams.range_m(i + 1));
    if (!alone) visit(i);
  }
}

/// Cuts the beams at the spikes of their derivative (Shalal et al. 2013, figure 6).
std::vector<Candidate> find_candidates(const Beams& beams);

/// Removes a border beam whose footprint covers the object and a surface behind or in front of it
/// (mixed pixel).
void trim_border(const Beams& beams, Candidate& candidate);

/// Position of an object's edge relative to its outermost beam.
struct Side {
  double beyond_beams = 0.5;              ///< distance from that beam to the edge; may be < 0
  double sd_beams = 0.28867513459481287;  ///< 1-sigma: uniform within a beam step
  bool hidden = false;                    ///< the edge is not visible; its position is unknown
};

struct Sides {
  Side before, after;
};

/// Determines both sides of a candidate. A side is hidden beside the end of the scan, a blind
/// sector or a nearer object. At a free side the spot meets the object before the beam's axis does,
/// so the edge is half a spot nearer to the beam.
Sides sides_of(const Beams& beams, const Candidate& candidate, const LaserConfig& laser);

/// Fills `arc` with the measurements for a circle fit, in a frame whose x axis is the candidate's
/// first beam and whose bearings increase with the position.
void arc_of(const Beams& beams, const Candidate& candidate, const Sides& sides, Arc& arc);

/// Fits circles to the candidates of one scan and caches one fit per candidate.
class CandidateFitter {
 public:
  CandidateFitter(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser);

  /// Fits a circle of radius below width_max_m / 2; none if the fit is larger or fails.
  std::optional<CircleFit> operator()(const Candidate& candidate);
  /// As operator(), but returns only a good fit (see tuning::kGoodFit). Starts from `near`; not
  /// cached.
  std::optional<CircleFit> good(const Candidate& candidate,
                                const std::optional<CircleFit>& near = {},
                                const std::optional<RadiusPrior>& prior = {});
  /// Fits a circle of any radius up to width_max_m.
  const std::optional<CircleFit>& any(const Candidate& candidate);
  /// The measurements for a circle fit; valid until the next call.
  const Arc& arc(const Candidate& candidate);
  /// 1-sigma of a range on a candidate.
  double range_sd_m(const Candidate& candidate) const {
    return laser_.range_sd_at(beams_.range_m(candidate.first));
  }

 private:
  struct Known {
    Candidate candidate;
    std::optional<CircleFit> circle;
  };

  const Beams& beams_;
  const SegmentationConfig& config_;
  const LaserConfig& laser_;
  Arc arc_;
  std::vector<Known> known_;
  /// Index into known_ by a candidate's first beam; -1 = none.
  std::vector<std::int32_t> last_known_;
};

/// Whether a circle was found and its fit is good.
inline bool fits(const std::optional<CircleFit>& fit) {
  return fit && fit->chi2_per_dof() < tuning::kGoodFit;
}

}  // namespace orchard::laser
