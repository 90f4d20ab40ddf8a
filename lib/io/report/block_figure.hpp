// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "io/figure/map_frame.hpp"
#include "io/report/document.hpp"
#include "io/report/report_texts.hpp"
#include "mapping/inventory/inventory.hpp"

namespace orchard::io {

/// The block as its grower knows it: trees with the thickness of their trunks, empty places and
/// other things, rows by their numbers.
DocumentFigure block_figure(const std::vector<mapping::Landmark>& landmarks,
                            const mapping::Inventory& inventory, std::optional<double> north_rad,
                            const ReportTexts& texts);

/// Bars of how many trees have which diameter.
DocumentFigure diameter_figure(const mapping::DiameterHistogram& histogram,
                               const ReportTexts& texts);

}  // namespace orchard::io
