// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "laser/beams.hpp"
#include "laser/candidate.hpp"
#include "laser/circle_fit.hpp"
#include "laser/laser_config.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/sides.hpp"

namespace orchard::laser {

/// Fits circles to the candidates of one scan and caches one fit per candidate.
class CandidateFitter {
 public:
  CandidateFitter(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser);

  /// Fits a circle of radius below width_max_m / 2; none if the fit is larger or fails.
  std::optional<CircleFit> operator()(const Candidate& candidate);
  /// As operator(), but returns only a good fit (see kGoodFit). Starts from `near`; not cached.
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
  return fit && fit->chi2_per_dof() < kGoodFit;
}

}  // namespace orchard::laser
