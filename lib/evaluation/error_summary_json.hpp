// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "evaluation/map_evaluation.hpp"

namespace orchard::evaluation {

/// Number of errors, their mean, root mean square and max [m], as an object of any JSON type.
template <class Json>
Json errors_json(const ErrorSummary& summary) {
  return {{"n", summary.num},
          {"mean_m", summary.mean_m},
          {"rms_m", summary.rms_m},
          {"max_m", summary.max_m}};
}

}  // namespace orchard::evaluation
