// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/candidate.hpp"
#include "laser/circle_fit.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/width_config.hpp"

namespace orchard::laser {

/// Evidence that the beams of one candidate lie on a circle, on two, or on a line, as costs:
/// -2 ln of the probability of the beams with the model's parameters integrated out (Laplace), but
/// for what all models share (the two outer sides and the range). A lower cost is more probable.
///
/// A width is drawn from the trunks (WidthConfig) or, as probable, from anything up to
/// SegmentationConfig::width_max_m. Chi2 is counted as its excess over the number of measurements,
/// so that a beam to which a model gives no weight speaks neither for nor against it.
class PartEvidence {
 public:
  /// `beam_spacing_m` is range x bearing step, `span_m` the distance between the outermost beams.
  PartEvidence(const WidthConfig& width, const SegmentationConfig& config, double beam_spacing_m,
               double span_m, double range_sd_m, int num_beams);

  /// Cost of a circle; `part` says on which of its sides another part touches it.
  double of_circle(const CircleFit& circle, const Candidate& part) const;
  /// Cost of a trunk of which a side is hidden behind the part beside it; `circle` was fitted with
  /// radius_prior().
  double of_hidden_trunk(const CircleFit& circle) const;
  RadiusPrior radius_prior() const { return {0.5 * width_.mean_m, 0.5 * width_sd_m_}; }
  /// Cost of a line; `chi2` is that of line_chi2(), with that of its two visible sides, which it
  /// meets exactly.
  double of_line(double chi2) const;
  /// Cost of a second circle beside the first: its depth, and how seldom two stems touch.
  double of_second_circle() const;
  /// Lower limit of the cost of two circles, however they share the span; noise goes below it in 1
  /// of 1000 candidates.
  double least_of_two() const;

 private:
  double of_width(double width_m, double width_sd_m) const;

  WidthConfig width_;
  double width_sd_m_, width_max_m_, beam_spacing_m_, span_m_, of_depth_;
  int num_beams_;
};

}  // namespace orchard::laser
