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

/// A landmark as somebody left it in another program.
struct EditedLandmark {
  std::int32_t id = 0;  ///< 0: it has none, it was drawn there
  Eigen::Vector2d p_map{0.0, 0.0};
  detection::Label label = detection::Label::kTree;
  double width_m = 0.0;       ///< 0: unknown
  std::int32_t row = 0;       ///< 0: none
  std::int32_t position = 0;  ///< 0: none
  std::string note;
};

/// A map as it came back from another program.
struct EditedMap {
  std::vector<EditedLandmark> landmarks;
  std::map<std::int32_t, std::string> row_names;  ///< of the rows that it holds
};

struct EditedMapOptions {
  std::int64_t utime = 0;  ///< when, of the corrections
  std::string who;
  bool keep_missing = false;  ///< what the edited map lacks was not deleted
};

/// What somebody did to a map elsewhere, as corrections of it.
struct EditedMapCorrections {
  std::vector<Correction> corrections;  ///< without numbers
  std::vector<std::string> left_out;    ///< what no correction can say, a sentence each
};

/// Two places nearer than this are one: programs keep degrees to seven decimals [m].
inline constexpr double kEditedPlace_m = 0.01;

/// A width that differs by less is the same, as files round it [m].
inline constexpr double kEditedWidth_m = 0.001;

/// The corrections that make `edited` of `before`, the map as it was given away: deleted, added,
/// moved, classes, numbers, notes, names of rows. `next_id` is free in the map as it is now.
EditedMapCorrections corrections_of(const CorrectedMap& before, const EditedMap& edited,
                                    std::int32_t next_id, const EditedMapOptions& options);

/// Which of the new corrections a map takes: those that would contradict what it and the earlier
/// ones say now are left out, a sentence each in `conflicts`; what is so already goes unsaid.
std::vector<Correction> corrections_that_fit(const std::vector<Landmark>& landmarks,
                                             std::int32_t next_id,
                                             const std::vector<Correction>& earlier,
                                             std::vector<Correction> added,
                                             std::vector<std::string>& conflicts);

}  // namespace orchard::mapping
