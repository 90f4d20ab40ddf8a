// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/corrections/apply_corrections.hpp"

namespace orchard::mapping {

/// A landmark as left by another program.
struct EditedLandmark {
  std::int32_t id = 0;  ///< 0: drawn in that program
  Eigen::Vector2d p_map{0.0, 0.0};
  detection::Label label = detection::Label::kTree;
  double width_m = 0.0;       ///< 0: unknown
  std::int32_t row = 0;       ///< 0: none
  std::int32_t position = 0;  ///< 0: none
  std::string note;
};

/// A map as returned by another program.
struct EditedMap {
  std::vector<EditedLandmark> landmarks;
  std::map<std::int32_t, std::string> row_names;  ///< of the rows in the file
};

/// Options of corrections_of().
struct EditedMapOptions {
  std::int64_t utime = 0;  ///< time of the corrections
  std::string who;
  bool keep_missing = false;  ///< landmarks missing from the edited map were not deleted
};

/// Changes made to a map in another program, as corrections.
struct EditedMapCorrections {
  std::vector<Correction> corrections;  ///< without numbers
  std::vector<std::string> left_out;  ///< changes that no correction can express, one sentence each
};

/// derived: Positions closer than this are equal: programs store degrees to seven decimals [m].
inline constexpr double kEditedPlace_m = 0.01;

/// derived: Widths that differ by less are equal: files are rounded [m].
inline constexpr double kEditedWidth_m = 0.001;

/// Returns the corrections that turn `before`, the exported map, into `edited`: deleted, added,
/// moved, class, number, note, row name. `next_id`: first free id of the current map.
EditedMapCorrections corrections_of(const CorrectedMap& before, const EditedMap& edited,
                                    std::int32_t next_id, const EditedMapOptions& options);

/// Selects the new corrections that can be applied. Those that contradict the map and the earlier
/// corrections are left out, with a sentence each in `conflicts`; those already satisfied are left
/// out silently.
std::vector<Correction> corrections_that_fit(const std::vector<Landmark>& landmarks,
                                             std::int32_t next_id,
                                             const std::vector<Correction>& earlier,
                                             std::vector<Correction> added,
                                             std::vector<std::string>& conflicts);

}  // namespace orchard::mapping
