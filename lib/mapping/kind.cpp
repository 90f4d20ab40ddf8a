// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/kind.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "mapping/tuning.hpp"

namespace orchard::mapping {

Kind kind_of(const Landmark& landmark) {
  if (landmark.label == detection::Label::kObject) return Kind::kObject;
  if (landmark.label == detection::Label::kUnseen) return Kind::kUnseen;
  return landmark.row > 0 ? Kind::kTree : Kind::kTrunk;
}

bool may_be_tree(const Landmark& landmark) {
  static const double surely_none = 1.0 / (1.0 + std::exp(-tuning::kSurelyNone));
  if (landmark.label == detection::Label::kUnseen) return landmark.probability >= surely_none;
  return landmark.label != detection::Label::kObject;
}

KindCounts::KindCounts(const std::vector<Landmark>& landmarks) {
  for (const Landmark& l : landmarks) ++num[static_cast<std::size_t>(kind_of(l))];
}

const char* KindCounts::name(Kind kind) const {
  switch (kind) {
    case Kind::kTree:
      return "trees in rows";
    case Kind::kTrunk:
      return has_rows() ? "other trunks" : "trunks";
    case Kind::kObject:
      return "objects";
    case Kind::kUnseen:
      break;
  }
  return "unseen";
}

std::string KindCounts::text() const {
  std::string text;
  for (const Kind kind : {Kind::kTree, Kind::kTrunk, Kind::kObject, Kind::kUnseen}) {
    if (of(kind) == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(of(kind)) + " " + name(kind);
  }
  return text.empty() ? "none" : text;
}

std::vector<Landmark> counted_trunks(const std::vector<Landmark>& landmarks) {
  const KindCounts counts(landmarks);
  std::vector<Landmark> trunks;
  std::copy_if(landmarks.begin(), landmarks.end(), std::back_inserter(trunks),
               [&](const Landmark& l) { return counts.counts(kind_of(l)); });
  return trunks;
}

}  // namespace orchard::mapping
