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

/// Fits circles to the runs of one scan, to each once.
class RunFitter {
 public:
  RunFitter(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser);

  /// A circle that may be a trunk: half as wide as the widest thing at most.
  std::optional<CircleFit> operator()(const Run& run);
  /// The same, if it is a good one; found from `near`, and not kept.
  std::optional<CircleFit> good(const Run& run, const std::optional<CircleFit>& near = {});
  /// As wide as it may be.
  const std::optional<CircleFit>& any(const Run& run);
  /// What a circle is fitted to; valid until the next call.
  const Arc& arc(const Run& run);
  /// 1-sigma of a range on a run.
  double range_sd_m(const Run& run) const { return laser_.range_sd_at(beams_.range_m(run.first)); }

 private:
  struct Known {
    Run run;
    std::optional<CircleFit> circle;
  };

  const Beams& beams_;
  const SegmentationConfig& config_;
  const LaserConfig& laser_;
  Arc arc_;
  std::vector<Known> known_;
  std::vector<std::int32_t> last_known_;  ///< index into known_ by a run's first beam; -1 = none
};

inline bool fits(const std::optional<CircleFit>& fit) {
  return fit && fit->chi2_per_dof() < kGoodFit;
}

}  // namespace orchard::laser
