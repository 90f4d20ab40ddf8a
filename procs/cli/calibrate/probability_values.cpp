// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/probability_values.hpp"

#include <string>

#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

std::string list_text(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values) {
    text += (text.size() > 1 ? ", " : "") + fixed_text(value, 4);
  }
  return text + "]";
}

}  // namespace

std::vector<io::ConfigValue> probability_values(const calibration::ProbabilityFit& fit) {
  return {{"detector.probability.enabled", "true"},
          {"detector.probability.judged_tree", list_text(fit.config.judged_tree)},
          {"detector.probability.judged_object", list_text(fit.config.judged_object)},
          {"detector.probability.laser_tree", list_text(fit.config.laser_tree)},
          {"detector.probability.laser_object", list_text(fit.config.laser_object)},
          {"mapper.evidence_prior", fixed_text(fit.prior, 3)},
          {"mapper.evidence_base_rate", fixed_text(fit.base_rate, 3)},
          {"mapper.evidence_correlation", fixed_text(fit.correlation, 3)}};
}

}  // namespace orchard::cli
