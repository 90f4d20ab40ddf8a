// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/trunks/trunk_observation.hpp"
#include "calibration/trunks/width_by_range.hpp"
#include "vision/colour.hpp"

namespace orchard::calibration {

/// A circular interval of hues; min_deg > max_deg wraps through red.
struct HueInterval {
  double min_deg = 0.0;
  double max_deg = 0.0;
  double width_deg = 0.0;
};

/// Adds a histogram's counts to another.
void add(const vision::HueHistogram& hues, vision::HueHistogram& sum);

/// The shortest circular interval that excludes at most the fraction `tail` of the coloured pixels
/// at each end (counted from the hue opposite their mean), widened by a margin on both sides.
/// Throws std::invalid_argument without coloured pixels.
HueInterval hue_interval(const vision::HueHistogram& hues, double tail, double margin_deg);

/// Position of a trunk picked by the user.
struct PickedTrunk {
  int id = 0;  ///< of the landmark in an earlier map
  double x_m = 0.0;
  double y_m = 0.0;
};

/// Options for associating observations and selecting the trunks.
struct TrunkModelOptions {
  int wanted_trunks = 20;        ///< fewer trunks give a warning
  int min_observations = 3;      ///< min number of observations of a trunk
  int min_beams = 4;             ///< of the observations
  double gate_m = 0.3;           ///< association gate
  double width_spread = 0.25;    ///< max relative difference of a trunk from the typical width
  double hue_spread_deg = 20.0;  ///< max difference from the typical dominant hue
  double hue_tail = 0.02;        ///< fraction of coloured pixels excluded at each end
  double hue_margin_deg = 2.0;   ///< added to the hue interval at each end
  double separation_min = 4.0;   ///< min separation of populations in pooled standard deviations
  double fraction_min = 0.6;     ///< min fraction of the trunks in the two largest populations
  std::vector<PickedTrunk> picked_trunks;  ///< positions of the trunks in map; empty: automatic
  std::vector<std::size_t> judged;         ///< or the objects that select_trunks() judged as trunks
};

/// One object that was observed several times.
struct ObservedObject {
  int log = 0;
  double x_m = 0.0;  ///< mean position, or the last one if there were no poses
  double y_m = 0.0;
  int num_observations = 0;
  double median_width_m = 0.0;
  double dominant_hue_deg = 0.0;
  bool is_trunk = false;                  ///< picked, or belongs to the dominant population
  bool is_doubtful = false;               ///< neither trunk nor anything else for certain
  std::vector<std::size_t> observations;  ///< indices of its observations
};

/// "trunk", "doubtful" or "other".
const char* class_name(const ObservedObject& seen);

/// Parameters of trunks for eqs. 9, 10 and figure 8.
struct TrunkModel {
  double width_mean_m = 0.0;
  double width_sd_m = 0.0;  ///< of single observations: scatter of the trunks and of the scanner
  WidthByRange width_by_range;
  /// Growth by the laser spot in addition to the rig's; subtracted from the widths if significant.
  std::optional<SpotDivergence> spot;
  bool has_hue = false;
  double hue_min_deg = 0.0;  ///< circular interval, may wrap through red
  double hue_max_deg = 0.0;
  bool is_picked = false;      ///< the trunks were picked by the user
  double width_spread = 0.25;  ///< as in TrunkModelOptions
  int num_trunks = 0;
  int num_observations = 0;             ///< number of used observations of trunks
  std::vector<ObservedObject> objects;  ///< all objects, in order of log and first observation
  std::vector<std::string> warnings;
};

/// Estimates the trunk model from observations of all objects: associates the observations (by
/// position if in_map, otherwise from scan to scan), takes for the trunks the objects of
/// similar width and colour with the most observations that stand alone (parts of a bush have
/// others beside them), and computes robust statistics. `observations` are in order of log and
/// time.
///
/// With picks, exactly those objects are trunks. Warns when the trunks form two groups of width, or
/// when another population is not separated from them or about as large.
///
/// Throws std::runtime_error with one sentence when there is no trunk, or a pick was not observed.
/// Source: Shalal et al. 2013, sections 4.1 and 4.2 (20 trees, mu, sigma, H_min, H_max).
TrunkModel estimate_trunk_model(const std::vector<TrunkObservation>& observations,
                                const TrunkModelOptions& options);

}  // namespace orchard::calibration
