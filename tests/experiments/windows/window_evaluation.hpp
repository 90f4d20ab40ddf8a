// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "vision/pixel_block.hpp"

namespace orchard::evaluation {

/// Brightens a picture by a factor of 2 in light per EV; clipped at white.
vision::PixelBlock exposed(const vision::PixelBlock& pixels, double exposure_ev);

/// Scores of the colour models for a window with known truth.
struct ScoredWindow {
  int group = 0;  ///< index of the tree: windows of one group are similar
  bool is_trunk = false;
  double appearance = 0.0;          ///< confidence of the learnt model
  double hue_interval = 0.0;        ///< roc_colour with the hue interval of the same model file
  double paper_hue_interval = 0.0;  ///< roc_colour with the paper's interval
};

/// Area under a ROC curve with its 95 % interval, by a bootstrap over groups.
struct AreaEstimate {
  double area = 0.5;
  double low = 0.5;
  double high = 0.5;
};

/// Separation of windows on trunks from other windows.
struct WindowEvaluation {
  int num_pictures = 0;
  int num_groups = 0;
  int num_trunk = 0;  ///< windows
  int num_other = 0;
  AreaEstimate appearance;
  AreaEstimate hue_interval;
  AreaEstimate paper_hue_interval;
  double confidence_min = 0.5;
  double found_fraction = 0.0;  ///< of the windows on trunks with at least confidence_min
  double false_fraction = 0.0;  ///< of the other windows
};

/// Evaluates scored windows. Deterministic. The caller sets num_pictures.
WindowEvaluation evaluate_windows(const std::vector<ScoredWindow>& windows, double confidence_min);

/// The results as one JSON object.
std::string window_json(const WindowEvaluation& evaluation);

}  // namespace orchard::evaluation
