// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/corrections/correction_words.hpp"

#include "detection/detection.hpp"
#include "text/number_text.hpp"

namespace orchard::mapping {

std::string correction_words(const Correction& c) {
  std::string words = correction_word(c.kind);
  for (const auto& target : c.targets) words += " " + std::to_string(target.id);
  if (c.of != 0) words += " " + std::to_string(c.of);
  if (c.new_id != 0) words += " new " + std::to_string(c.new_id);
  if (c.kind == CorrectionKind::kClass) {
    words += std::string(" ") + detection::label_text(c.label);
  }
  const bool is_row = c.kind == CorrectionKind::kRowName;
  if (c.row != 0) words += (is_row ? " " : " row ") + std::to_string(c.row);
  if (c.position != 0) words += " tree " + std::to_string(c.position);
  if (!c.name.empty()) words += " \"" + c.name + "\"";
  for (const auto& p : c.places_map) {
    words += " at " + fixed_text(p.x(), 2) + " " + fixed_text(p.y(), 2);
  }
  return words;
}

const char* outcome_word(CorrectionOutcome outcome) {
  switch (outcome) {
    case CorrectionOutcome::kApplied:
      return "applied";
    case CorrectionOutcome::kByPlace:
      return "by place";
    case CorrectionOutcome::kSatisfied:
      return "already so";
    case CorrectionOutcome::kConflict:
      return "conflict";
    case CorrectionOutcome::kUndone:
      break;
  }
  return "undone";
}

}  // namespace orchard::mapping
