// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "evaluation/map_evaluation.hpp"

namespace orchard::evaluation {

/// How many errors, their mean, root mean square and largest [m].
inline nlohmann::ordered_json errors_json(const ErrorSummary& summary) {
  return {{"n", summary.num},
          {"mean_m", summary.mean_m},
          {"rms_m", summary.rms_m},
          {"max_m", summary.max_m}};
}

}  // namespace orchard::evaluation
