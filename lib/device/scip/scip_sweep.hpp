// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "device/scip/scip_parameters.hpp"
#include "laser/scan.hpp"

namespace orchard::device {

/// What each beam of a sweep is sent as.
enum class ScipEncoding {
  kTwo,                 ///< MS: a range in two characters
  kThree,               ///< MD: a range in three characters
  kThreeWithIntensity,  ///< ME: a range and an intensity in three each
};

int characters_per_beam(ScipEncoding encoding);

/// A sweep as the scanner sent it.
struct ScipSweep {
  std::uint32_t ticks = 0;  ///< 24 bits of milliseconds, when the motor passed step 0
  laser::Scan scan;         ///< without utime and seq
};

/// Reads the lines after the status "99": time and ranges. None when a sum is wrong or there are
/// not exactly the characters of all beams.
///
/// What is not within DMIN to DMAX is an error code or beyond reach: no return.
std::optional<ScipSweep> parse_scip_sweep(const std::vector<std::string_view>& lines,
                                          const ScipParameters& parameters, ScipEncoding encoding);

}  // namespace orchard::device
