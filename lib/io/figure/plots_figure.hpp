// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/plot.hpp"
#include "io/figure/canvas.hpp"

namespace orchard::io {

/// Draws plots in two columns, each with title, legend and axes. Returns the file.
std::string plots_figure(const std::vector<evaluation::Plot>& plots, FigureFormat format);

}  // namespace orchard::io
