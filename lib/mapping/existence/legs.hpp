// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

/// Legs at the height of knees and calves are 0.10 to 0.14 m thick (a girth of 0.33 to 0.43 m);
/// trousers and what a scanner errs make them this wide at most, and half hidden ones narrower [m].
inline constexpr double kLegMin_m = 0.08, kLegMax_m = 0.22;

/// The middles of the two legs of a standing person [m].
inline constexpr double kStanceMin_m = 0.10, kStanceMax_m = 0.45;

}  // namespace orchard::mapping
