// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/corrections/correction.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Result of applying a correction.
enum class CorrectionOutcome {
  kApplied,
  kByPlace,    ///< applied to a similar landmark there, because the id was not found
  kSatisfied,  ///< the map already agrees
  kConflict,   ///< not applied: a person must decide
  kUndone,
};

/// Result of one correction.
struct CorrectionResult {
  std::int32_t number = 0;
  CorrectionOutcome outcome = CorrectionOutcome::kApplied;
  std::string reason;  ///< for kByPlace, kSatisfied, kConflict: a sentence without full stop
};

/// A map after corrections.
struct CorrectedMap {
  std::vector<Landmark> landmarks;                         ///< in order of id
  std::map<std::int32_t, std::string> row_names;           ///< of rows with a name
  std::map<std::int32_t, std::vector<std::string>> notes;  ///< of landmarks, by id
  std::vector<CorrectionResult> results;                   ///< one per correction, in order
  std::int32_t next_id = 1;                                ///< free in the map and the corrections

  int count(CorrectionOutcome outcome) const;
};

/// Applies corrections in order to a map; `next_id` is its first free id.
///
/// A target is found by its id, if that landmark is within reach of any position it has had, else
/// it is the nearest landmark there of the same class and similar width (factor kLikeWidth). A
/// target that is not found, or a correction that contradicts the map, is a conflict and changes
/// nothing, like an undone correction. Reach: 0.35 of the typical spacing, 0.1 to 0.5 m, as for
/// keeping ids between two drives. Added landmarks have no observations, and width 0 if it is
/// unknown.
/// `row_names`: names that rows have before the corrections, by number.
CorrectedMap apply_corrections(const std::vector<Landmark>& landmarks, std::int32_t next_id,
                               const std::vector<Correction>& corrections,
                               std::map<std::int32_t, std::string> row_names = {});

/// derived: Max ratio of the widths of one object.
inline constexpr double kLikeWidth = 2.0;

/// Which corrections hold after all undo and redo entries: one flag each, in order. An undo of a
/// correction that does not hold, and a redo of one that does, have no effect.
std::vector<bool> corrections_that_hold(const std::vector<Correction>& corrections);

/// Number of the last correction that holds, which a plain undo takes back; 0 for none.
std::int32_t last_to_undo(const std::vector<Correction>& corrections);

/// Number of the correction undone last, if nothing was corrected since; 0 for none.
std::int32_t last_to_redo(const std::vector<Correction>& corrections);

/// Describes a correction for people: `delete 17`, `row 3 "north"`, `move 4 at 1.50 2.00`. Contains
/// names as people entered them, unescaped.
std::string correction_words(const Correction& correction);

/// Text of an outcome: "applied", "by place", "already so", "conflict", "undone".
const char* outcome_word(CorrectionOutcome outcome);

/// Landmarks used to keep ids when the earlier map was corrected: all landmarks of the earlier run,
/// then those added by people (from `corrected`). A tree that was missed earlier and is seen now
/// thus gets the id that people gave it.
std::vector<Landmark> known_landmarks(const std::vector<Landmark>& earlier,
                                      const std::vector<Landmark>& corrected);

/// Converts corrections of an earlier map for a new map of the same orchard, whose ids are kept
/// (keep_ids()) and which is aligned to the earlier one by `T_earlier_now`.
///
/// Positions are transformed by the alignment plus the local deformation of the known landmarks
/// around them.
std::vector<Correction> carry_corrections(const std::vector<Correction>& corrections,
                                          const std::vector<Landmark>& earlier,
                                          const std::vector<Landmark>& now,
                                          const geometry::Pose2& T_earlier_now);

}  // namespace orchard::mapping
