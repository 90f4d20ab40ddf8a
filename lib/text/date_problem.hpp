// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace orchard {

/// Why a text is not a day of the years that date_text() knows, written like 2026-04-30, and what
/// to write instead; empty: it is one.
std::string date_problem(std::string_view text);

}  // namespace orchard
