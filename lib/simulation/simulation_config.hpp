// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::simulation {

/// What the simulated world and sensors are like. Section `simulation`.
struct SimulationConfig {
  double range_error_fraction = 0.03;  ///< class limit of the laser's range error (+-3 %)
};

template <class Visitor>
void describe(Visitor& v, SimulationConfig& c) {
  v.number("range_error_fraction", c.range_error_fraction, 0, 0.5, "1",
           "class limit of the laser's range error");
}

}  // namespace orchard::simulation
