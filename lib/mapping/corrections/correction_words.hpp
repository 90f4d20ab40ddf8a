// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mapping/corrections/apply_corrections.hpp"

namespace orchard::mapping {

/// What a correction does, for people: `delete 17`, `row 3 "north"`, `move 4 at 1.50 2.00`. Names
/// in it are as somebody wrote them.
std::string correction_words(const Correction& correction);

/// "applied", "by place", "already so", "conflict", "undone".
const char* outcome_word(CorrectionOutcome outcome);

}  // namespace orchard::mapping
