// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mapping/corrections/apply_corrections.hpp"

namespace orchard::mapping {

/// Describes a correction for people: `delete 17`, `row 3 "north"`, `move 4 at 1.50 2.00`. Contains
/// names as people entered them, unescaped.
std::string correction_words(const Correction& correction);

/// Text of an outcome: "applied", "by place", "already so", "conflict", "undone".
const char* outcome_word(CorrectionOutcome outcome);

}  // namespace orchard::mapping
