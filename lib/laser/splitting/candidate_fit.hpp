// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "laser/beams.hpp"
#include "laser/circle_fit.hpp"
#include "laser/cut.hpp"
#include "laser/laser_config.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/sides.hpp"

namespace orchard::laser {

/// Fits circles to the candidates of one scan and caches one fit per candidate.
class CandidateFitter {
 public:
  CandidateFitter(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser);

  /// The circle of a candidate that may be a trunk: at most half as wide as width_max_m.
  std::optional<CircleFit> operator()(const Candidate& candidate);
  /// The same only if it fits within noise; started from `near` and not cached.
  std::optional<CircleFit> good(const Candidate& candidate,
                                const std::optional<CircleFit>& near = {});
  /// The circle at any radius up to width_max_m.
  const std::optional<CircleFit>& any(const Candidate& candidate);
  /// What a circle is fitted to; valid until the next call.
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
  std::vector<std::int32_t>
      last_known_;  ///< index into known_ by a candidate's first beam; -1 = none
};

inline bool fits(const std::optional<CircleFit>& fit) {
  return fit && fit->chi2_per_dof() < kGoodFit;
}

}  // namespace orchard::laser
