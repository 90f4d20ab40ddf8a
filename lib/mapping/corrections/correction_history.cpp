// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>

#include "mapping/corrections/apply_corrections.hpp"

namespace orchard::mapping {
namespace {

/// Stacks of undo and redo.
struct History {
  std::vector<std::int32_t> done;    ///< numbers of corrections that hold; the last is undone first
  std::vector<std::int32_t> undone;  ///< numbers of undone corrections; the last is redone first
};

bool take(std::vector<std::int32_t>& numbers, std::int32_t number) {
  const auto found = std::find(numbers.rbegin(), numbers.rend(), number);
  if (found == numbers.rend()) return false;
  numbers.erase(std::next(found).base());
  return true;
}

History history_of(const std::vector<Correction>& corrections) {
  History history;
  for (const Correction& c : corrections) {
    if (c.kind == CorrectionKind::kUndo) {
      if (take(history.done, c.of)) history.undone.push_back(c.of);
    } else if (c.kind == CorrectionKind::kRedo) {
      if (take(history.undone, c.of)) history.done.push_back(c.of);
    } else {
      history.done.push_back(c.number);
    }
  }
  return history;
}

}  // namespace

const char* correction_word(CorrectionKind kind) {
  switch (kind) {
    case CorrectionKind::kDelete:
      return "delete";
    case CorrectionKind::kAdd:
      return "add";
    case CorrectionKind::kMove:
      return "move";
    case CorrectionKind::kClass:
      return "class";
    case CorrectionKind::kMerge:
      return "merge";
    case CorrectionKind::kSplit:
      return "split";
    case CorrectionKind::kRowName:
      return "row";
    case CorrectionKind::kRenumber:
      return "renumber";
    case CorrectionKind::kNote:
      return "note";
    case CorrectionKind::kUndo:
      return "undo";
    case CorrectionKind::kRedo:
      break;
  }
  return "redo";
}

std::vector<bool> corrections_that_hold(const std::vector<Correction>& corrections) {
  std::map<std::int32_t, bool> holds;
  for (const std::int32_t number : history_of(corrections).done) holds[number] = true;
  std::vector<bool> flags;
  for (const Correction& c : corrections) flags.push_back(holds.count(c.number) != 0);
  return flags;
}

std::int32_t last_to_undo(const std::vector<Correction>& corrections) {
  const History history = history_of(corrections);
  return history.done.empty() ? 0 : history.done.back();
}

std::int32_t last_to_redo(const std::vector<Correction>& corrections) {
  std::vector<std::int32_t> undone;
  for (const Correction& c : corrections) {
    if (c.kind == CorrectionKind::kUndo) {
      undone.push_back(c.of);
    } else if (c.kind == CorrectionKind::kRedo) {
      take(undone, c.of);
    } else {
      undone.clear();
    }
  }
  return undone.empty() ? 0 : undone.back();
}

}  // namespace orchard::mapping
