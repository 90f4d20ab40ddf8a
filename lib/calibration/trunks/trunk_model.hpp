// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/trunks/spot_growth.hpp"
#include "calibration/trunks/trunk_observation.hpp"
#include "calibration/trunks/width_by_range.hpp"

namespace orchard::calibration {

/// Where somebody says that a trunk stands.
struct PickedPlace {
  int id = 0;  ///< of the landmark in a first map
  double x_m = 0.0;
  double y_m = 0.0;
};

/// How trunks are told apart and from the rest.
struct TrunkModelOptions {
  int wanted_trunks = 20;        ///< fewer give a warning
  int min_observations = 3;      ///< of a thing that may be a trunk
  int fewest_beams = 4;          ///< of an observation, as they were gathered
  double gate_m = 0.3;           ///< farther observations are at another thing
  double width_spread = 0.25;    ///< trunks differ by at most this fraction from the typical one
  double hue_spread_deg = 20.0;  ///< and by at most this much in their dominant hue
  double hue_tail = 0.02;        ///< fraction of coloured pixels left out at each end
  double hue_margin_deg = 2.0;   ///< beyond the rest
  int hue_bins = 36;             ///< for dominant hues
  double separation_min = 4.0;   ///< nearer populations, in pooled sd, do not separate
  double fraction_min = 0.6;     ///< of the dominant population among the two largest
  std::vector<int> picked;       ///< numbers of things that are trunks, from 1; empty: automatic
  std::vector<PickedPlace> picked_places;  ///< or where trunks stand in map
};

/// One thing that was seen several times.
struct ThingSeen {
  int log = 0;
  double x_m = 0.0;  ///< mean, or last seen when there were no poses
  double y_m = 0.0;
  int num_observations = 0;
  double median_width_m = 0.0;
  double dominant_hue_deg = 0.0;
  bool is_trunk = false;                  ///< picked, or belongs to the dominant population
  std::vector<std::size_t> observations;  ///< which observations are of it
};

/// What trunks are like, as eqs. 9, 10 and figure 8 need it.
struct TrunkModel {
  double width_mean_m = 0.0;
  double width_sd_m = 0.0;  ///< of single observations: the trunks' own scatter and the scanner's
  WidthByRange width_by_range;
  /// Of the spot, beside what the rig takes off; where it is significant, widths are less by it.
  std::optional<SpotGrowth> spot;
  bool has_hue = false;
  double hue_min_deg = 0.0;  ///< circular interval, may wrap through red
  double hue_max_deg = 0.0;
  bool is_picked = false;      ///< somebody said which things are trunks
  double width_spread = 0.25;  ///< as TrunkModelOptions has it
  int num_trunks = 0;
  int num_observations = 0;       ///< observations of them that were used
  std::vector<ThingSeen> things;  ///< all, in order of log and first sight
  std::vector<std::string> warnings;
};

/// Measures the trunk model from looks at everything: follows things through the observations (`in
/// map` by place, otherwise from observation to observation), takes the largest group alike in
/// width and hue for the trunks, and gives robust statistics of them. Observations stand in order
/// of log and time.
///
/// With picks, exactly those things are trunks. Warns when trunks fall into two groups of width, or
/// when another population does not separate from them, or is about as large.
///
/// Throws std::runtime_error with one sentence when nothing can be learnt, or a pick was not seen.
/// Source: Shalal et al. 2013, sections 4.1 and 4.2 (20 trees, mu, sigma, H_min, H_max).
TrunkModel estimate_trunk_model(const std::vector<TrunkObservation>& observations,
                                const TrunkModelOptions& options);

}  // namespace orchard::calibration
