// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::evaluation {

/// What the colour models say of a window whose truth is known.
struct ScoredWindow {
  int group = 0;  ///< of the tree: windows of one group resemble each other
  bool is_trunk = false;
  double appearance = 0.0;          ///< confidence of the learnt model
  double hue_interval = 0.0;        ///< roc_colour by the interval of the same model file
  double paper_hue_interval = 0.0;  ///< and by the paper's
};

/// Area under a ROC curve with its 95 % interval, by drawing groups anew (bootstrap).
struct AreaEstimate {
  double area = 0.5;
  double low = 0.5;
  double high = 0.5;
};

/// How well windows on trunks are told from windows elsewhere.
struct WindowEvaluation {
  int num_pictures = 0;
  int num_groups = 0;
  int num_trunk = 0;  ///< windows
  int num_other = 0;
  AreaEstimate appearance;
  AreaEstimate hue_interval;
  AreaEstimate paper_hue_interval;
  double confidence_min = 0.5;
  double found_fraction = 0.0;        ///< of the windows on trunks, from confidence_min on
  double false_fraction = 0.0;        ///< of the windows elsewhere
  std::vector<std::string> left_out;  ///< pictures that could not be used, and why
};

/// Judges scored windows. The same windows give the same figures. num_pictures and left_out are
/// the caller's.
WindowEvaluation evaluate_windows(const std::vector<ScoredWindow>& windows, double confidence_min);

/// The figures for a person, one per line.
std::string window_summary(const WindowEvaluation& evaluation);

/// The figures for programs: one JSON object.
std::string window_json(const WindowEvaluation& evaluation);

}  // namespace orchard::evaluation
