// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace orchard {

/// Escapes & < > " for XML and HTML, in element content or between double quotes.
std::string markup_text(std::string_view text);

}  // namespace orchard
