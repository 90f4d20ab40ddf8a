// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mapping/corrections/correction.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

enum class CorrectionOutcome {
  kApplied,
  kByPlace,    ///< applied to what stands there and is alike; its id was another's or none's
  kSatisfied,  ///< the map itself says so already
  kConflict,   ///< not applied: a person has to look
  kUndone,
};

/// What became of one correction.
struct CorrectionResult {
  std::int32_t number = 0;
  CorrectionOutcome outcome = CorrectionOutcome::kApplied;
  std::string reason;  ///< of a conflict, by place, satisfied: a sentence without a full stop
};

/// A map as people know it.
struct CorrectedMap {
  std::vector<Landmark> landmarks;                         ///< in order of id
  std::map<std::int32_t, std::string> row_names;           ///< of the rows that have one
  std::map<std::int32_t, std::vector<std::string>> notes;  ///< of landmarks, by id
  std::vector<CorrectionResult> results;                   ///< one per correction, in their order
  std::int32_t next_id = 1;                                ///< neither map nor corrections had it

  int count(CorrectionOutcome outcome) const;
};

/// Applies corrections in their order to a map, whose `next_id` is free.
///
/// A target is the landmark of its id where that stands within reach of any place it has had, else
/// the nearest one there of the same class and like width (a factor of kLikeWidth). What cannot be
/// found, or would contradict the map, is a conflict and changes nothing; an undone correction
/// neither. Reach is a third of the distance at which things usually stand, 0.1 to 0.5 m, as for
/// ids between two drives. What is added has no observations, and width 0 where it is not known.
CorrectedMap apply_corrections(const std::vector<Landmark>& landmarks, std::int32_t next_id,
                               const std::vector<Correction>& corrections);

/// Widths that differ by more are another thing's.
inline constexpr double kLikeWidth = 2.0;

/// Which corrections hold after all undo and redo entries, in their order: one flag each. An undo
/// of what does not hold, and a redo of what does, changes nothing.
std::vector<bool> corrections_that_hold(const std::vector<Correction>& corrections);

/// The number of the last correction that holds; 0 for none: what a plain undo means.
std::int32_t last_to_undo(const std::vector<Correction>& corrections);

/// The number of the correction undone last, when nothing was corrected since; 0 for none.
std::int32_t last_to_redo(const std::vector<Correction>& corrections);

}  // namespace orchard::mapping
