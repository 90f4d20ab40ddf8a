// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/decision_errors.hpp"

#include <cstddef>

namespace orchard::calibration {

DecisionErrors decision_errors(const std::vector<ProbabilitySample>& samples,
                               const ProbabilityFit& fit) {
  DecisionErrors errors;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const detection::Label label = samples[i].detection.label;
    if (label == detection::Label::kUnseen || fit.left_out_tree[i] < 0.0) continue;
    const bool is_tree = samples[i].outcome == Outcome::kTree;
    ++errors.num;
    errors.roc += is_tree != (label == detection::Label::kTree);
    errors.probability += is_tree != (fit.left_out_tree[i] >= fit.config.tree_min);
  }
  return errors;
}

}  // namespace orchard::calibration
