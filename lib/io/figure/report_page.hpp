// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluation/plot.hpp"

namespace orchard::io {

/// Returns a self-contained HTML page: the plots as inline SVG, and text in columns below them.
std::string report_page(const std::string& title, const std::vector<evaluation::Plot>& plots,
                        const std::string& tables);

}  // namespace orchard::io
