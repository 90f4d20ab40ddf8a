// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "device/scip/scip_parameters.hpp"
#include "laser/scan.hpp"

namespace orchard::device {

/// Encoding of a beam.
enum class ScipEncoding {
  kTwo,                 ///< MS: a range in two characters
  kThree,               ///< MD: a range in three characters
  kThreeWithIntensity,  ///< ME: a range and an intensity in three each
};

int characters_per_beam(ScipEncoding encoding);

/// One sweep of the scanner.
struct ScipSweep {
  std::uint32_t ticks = 0;  ///< 24 bits of milliseconds; the motor passed step 0
  laser::Scan scan;         ///< without utime and seq
};

/// Parses the lines after the status "99": time and ranges. None when a checksum is wrong or the
/// number of characters does not match the number of beams.
///
/// Values outside DMIN to DMAX are error codes or out of reach: no return.
std::optional<ScipSweep> parse_scip_sweep(const std::vector<std::string_view>& lines,
                                          const ScipParameters& parameters, ScipEncoding encoding);

}  // namespace orchard::device
