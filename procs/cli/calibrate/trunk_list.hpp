// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/trunks/trunk_model.hpp"

namespace orchard::cli {

/// Writes a page for selecting trunks: `index.html` with one picture per object (its nearest
/// observation), its number, position, width, hue and number of observations; `things.csv` with the
/// same data; and the pictures. `observations` are those of the model. Throws io::FileError when
/// the folder cannot be written.
void write_trunk_list(const std::string& folder, const calibration::TrunkModel& model,
                      const std::vector<calibration::TrunkObservation>& observations);

}  // namespace orchard::cli
