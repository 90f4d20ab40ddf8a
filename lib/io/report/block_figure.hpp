// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "io/figure/map_frame.hpp"
#include "io/report/document.hpp"
#include "io/report/report_texts.hpp"
#include "mapping/inventory/inventory.hpp"

namespace orchard::io {

/// Draws the block for the grower: trees by trunk diameter, gaps, other objects and row numbers.
DocumentFigure block_figure(const std::vector<mapping::Landmark>& landmarks,
                            const mapping::Inventory& inventory, std::optional<double> north_rad,
                            const ReportTexts& texts);

/// Draws a histogram of trunk diameters.
DocumentFigure diameter_figure(const mapping::DiameterHistogram& histogram,
                               const ReportTexts& texts);

}  // namespace orchard::io
