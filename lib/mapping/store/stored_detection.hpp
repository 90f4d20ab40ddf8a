// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "detection/detection.hpp"
#include "mapping/candidate.hpp"
#include "mapping/observation.hpp"

namespace orchard::mapping {

/// Converts a candidate to its stored form; scan and previous are not set.
Observation observation_of(const Candidate& candidate);

/// Restores all fields of a stored detection that the map depends on.
detection::Detection detection_of(const Observation& observation);

}  // namespace orchard::mapping
