// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// What people call a landmark. A laser takes stems of bushes, posts and pieces of hedges for
/// trunks; that a trunk is a planted tree, its row tells.
enum class Kind {
  kTree,    ///< a trunk in a row of the map or of the grower's plan
  kTrunk,   ///< any other trunk
  kObject,  ///< no trunk
  kUnseen,  ///< never in the view of the camera, or it may be the ground
};
inline constexpr int kNumKinds = 4;  // derived: of the list above

Kind kind_of(const Landmark& landmark);

/// Whether maps that are laid on each other or on a plan take a landmark for a tree: not an object,
/// nor what was not seen well and is surely none.
bool may_be_tree(const Landmark& landmark);

/// Numbers of landmarks by kind.
struct KindCounts {
  KindCounts() = default;
  explicit KindCounts(const std::vector<Landmark>& landmarks);

  int of(Kind kind) const { return num[static_cast<std::size_t>(kind)]; }
  bool has_rows() const { return of(Kind::kTree) > 0; }
  /// Whether headlines, sums and histograms count this kind: trees in rows; without rows, as in a
  /// park, all trunks.
  bool counts(Kind kind) const { return kind == (has_rows() ? Kind::kTree : Kind::kTrunk); }
  /// What the figures call a kind: "trees in rows", "other trunks", "trunks", "objects", "unseen".
  const char* name(Kind kind) const;
  /// "41 trees in rows, 57 other trunks, 30 objects": the kinds that there are.
  std::string text() const;

  std::array<int, kNumKinds> num{};
};

/// The trunks that headlines, sums and histograms count.
std::vector<Landmark> counted_trunks(const std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
