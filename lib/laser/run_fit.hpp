// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "laser/beams.hpp"
#include "laser/circle_fit.hpp"
#include "laser/cut.hpp"
#include "laser/laser_config.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/sides.hpp"

namespace orchard::laser {

/// Fits circles to runs with one set of buffers.
class RunFitter {
 public:
  RunFitter(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser)
      : beams_(beams), config_(config), laser_(laser) {}

  std::optional<CircleFit> operator()(const Run& run) {
    return fit_circle(arc(run), beams_.step_rad(), range_sd_m(run), 0.5 * config_.width_max_m);
  }
  /// What a circle is fitted to; valid until the next call.
  const Arc& arc(const Run& run) {
    arc_of(beams_, run, sides_of(beams_, run, config_), arc_);
    return arc_;
  }
  /// 1-sigma of a range on a run.
  double range_sd_m(const Run& run) const { return laser_.range_sd_at(beams_.range_m(run.first)); }

 private:
  const Beams& beams_;
  const SegmentationConfig& config_;
  const LaserConfig& laser_;
  Arc arc_;
};

/// Chi2 per degree of freedom below which something fits as well as noise lets it.
constexpr double kGoodFit = 3.0;

inline bool fits(const std::optional<CircleFit>& fit) {
  return fit && fit->chi2_per_dof() < kGoodFit;
}

}  // namespace orchard::laser
