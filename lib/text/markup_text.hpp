// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace orchard {

/// Text as XML and HTML hold it, in an element or between double quotes: & < > " are escaped.
std::string markup_text(std::string_view text);

}  // namespace orchard
