// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/corrections/edited_map.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;
using Place = std::pair<std::int32_t, std::int32_t>;  ///< row and position

std::string note_of(const CorrectedMap& map, std::int32_t id) {
  std::string text;
  const auto found = map.notes.find(id);
  if (found == map.notes.end()) return text;
  for (const std::string& note : found->second) text += (text.empty() ? "" : "; ") + note;
  return text;
}

/// Compares an exported map with the edited one that came back.
class EditReader {
 public:
  EditReader(const CorrectedMap& before, std::int32_t next_id, const EditedMapOptions& options)
      : before_(before), next_id_(next_id), options_(options) {
    for (const Landmark& l : before.landmarks) known_[l.id] = &l;
  }

  EditedMapCorrections read(const EditedMap& edited) {
    pair(edited);
    if (!options_.keep_missing) {
      for (const auto& [id, l] : known_) {
        if (edited_.count(id) == 0) about(CorrectionKind::kDelete, *l);
      }
    }
    for (const auto& [id, e] : edited_) change(*known_.at(id), *e);
    for (const EditedLandmark* e : added_) add(*e);
    renumber();
    for (const auto& [row, name] : edited.row_names) name_row(row, name);
    return std::move(result_);
  }

 private:
  /// Pairs features by id. A copied feature has its original's id: the one nearest to the original
  /// position is the original, the others are new.
  void pair(const EditedMap& edited) {
    for (const EditedLandmark& e : edited.landmarks) {
      const auto known = known_.find(e.id);
      if (e.id == 0 || known == known_.end()) {
        added_.push_back(&e);
        continue;
      }
      const auto [at, is_first] = edited_.emplace(e.id, &e);
      if (is_first) continue;
      const Vector2d p(known->second->x_m, known->second->y_m);
      if ((e.p_map - p).norm() < (at->second->p_map - p).norm()) {
        added_.push_back(std::exchange(at->second, &e));
      } else {
        added_.push_back(&e);
      }
    }
  }

  Correction& push(CorrectionKind kind) {
    Correction c;
    c.kind = kind;
    c.utime = options_.utime;
    c.who = options_.who;
    result_.corrections.push_back(std::move(c));
    return result_.corrections.back();
  }
  /// Creates a correction about `l`, given as it is after the preceding corrections.
  Correction& about(CorrectionKind kind, const Landmark& l) {
    Correction& c = push(kind);
    c.targets = {{l.id, {l.x_m, l.y_m}, l.label, l.width_m}};
    return c;
  }

  void change(const Landmark& was, const EditedLandmark& e) {
    Landmark now = was;
    if (e.label != was.label) {
      if (e.label == detection::Label::kUnseen) {
        result_.left_out.push_back(std::to_string(e.id) +
                                   " cannot get class unseen; give tree or object");
      } else {
        about(CorrectionKind::kClass, now).label = e.label;
        now.label = e.label;
      }
    }
    if ((e.p_map - Vector2d(was.x_m, was.y_m)).norm() > kEditedPlace_m) {
      about(CorrectionKind::kMove, now).places_map = {e.p_map};
      now.x_m = e.p_map.x(), now.y_m = e.p_map.y();
    }
    if (e.width_m > 0.0 && std::abs(e.width_m - was.width_m) > kEditedWidth_m) {
      result_.left_out.push_back(std::to_string(e.id) +
                                 ": widths are measured and cannot be edited; the width was kept");
    }
    take_number(now, {was.row, was.position}, e);
    take_note(now, note_of(before_, e.id), e);
  }

  void take_number(const Landmark& now, const Place& was, const EditedLandmark& e) {
    const Place wanted{e.row, e.position};
    if (wanted == was || now.label != detection::Label::kTree) return;
    if (e.row == 0) {
      result_.left_out.push_back(std::to_string(now.id) +
                                 ": the row of a tree can be set or changed, but not removed");
      return;
    }
    renumbered_.push_back({now, was, wanted});
  }

  void take_note(const Landmark& now, const std::string& was, const EditedLandmark& e) {
    if (e.note == was) return;
    if (e.note.empty()) {
      result_.left_out.push_back(
          std::to_string(now.id) +
          ": a note cannot be removed this way; use `orchard edit undo MAP`");
      return;
    }
    const bool is_longer = !was.empty() && e.note.rfind(was + "; ", 0) == 0;
    about(CorrectionKind::kNote, now).note = is_longer ? e.note.substr(was.size() + 2) : e.note;
  }

  void add(const EditedLandmark& e) {
    Landmark l;
    l.id = next_id_++;
    l.x_m = e.p_map.x(), l.y_m = e.p_map.y();
    l.label = e.label == detection::Label::kUnseen ? detection::Label::kTree : e.label;
    l.width_m = e.width_m;
    Correction& c = push(CorrectionKind::kAdd);
    c.places_map = {e.p_map};
    c.new_id = l.id;
    c.label = l.label;
    c.width_m = e.width_m;
    if (e.row > 0 && e.position > 0 && copied_.insert({e.row, e.position}).second) {
      const bool is_taken = std::any_of(edited_.begin(), edited_.end(), [&](const auto& other) {
        return other.second->row == e.row && other.second->position == e.position;
      });
      if (!is_taken) take_number(l, {0, 0}, e);  // else a copy with its original's number
    }
    if (!e.note.empty() && e.id == 0) take_note(l, "", e);
  }

  /// Numbers that are exchanged between trees are first removed, then set.
  void renumber() {
    std::set<Place> wanted;
    for (const Renumbered& r : renumbered_) wanted.insert(r.wanted);
    for (const Renumbered& r : renumbered_) {
      if (r.was.second == 0 || wanted.count(r.was) == 0) continue;
      Correction& c = about(CorrectionKind::kRenumber, r.landmark);
      c.row = r.was.first;
      c.position = 0;
    }
    for (const Renumbered& r : renumbered_) {
      Correction& c = about(CorrectionKind::kRenumber, r.landmark);
      c.row = r.wanted.first;
      c.position = r.wanted.second;
    }
  }

  void name_row(std::int32_t row, const std::string& name) {
    const auto known = before_.row_names.find(row);
    const std::string was = known == before_.row_names.end() ? std::to_string(row) : known->second;
    if (name.empty() || name == was) return;
    Correction& c = push(CorrectionKind::kRowName);
    c.row = row;
    c.name = name;
  }

  struct Renumbered {
    Landmark landmark;
    Place was, wanted;
  };
  const CorrectedMap& before_;
  std::int32_t next_id_;
  const EditedMapOptions& options_;
  std::map<std::int32_t, const Landmark*> known_;
  std::map<std::int32_t, const EditedLandmark*> edited_;
  std::vector<const EditedLandmark*> added_;
  std::vector<Renumbered> renumbered_;
  std::set<Place> copied_;
  EditedMapCorrections result_;
};

std::string words_of(const Correction& c) {
  std::string words = correction_word(c.kind);
  for (const CorrectionTarget& target : c.targets) words += " " + std::to_string(target.id);
  if (c.kind == CorrectionKind::kRowName) words += " " + std::to_string(c.row);
  return words;
}

}  // namespace

EditedMapCorrections corrections_of(const CorrectedMap& before, const EditedMap& edited,
                                    std::int32_t next_id, const EditedMapOptions& options) {
  return EditReader(before, next_id, options).read(edited);
}

std::vector<Correction> corrections_that_fit(const std::vector<Landmark>& landmarks,
                                             std::int32_t next_id,
                                             const std::vector<Correction>& earlier,
                                             std::vector<Correction> added,
                                             std::vector<std::string>& conflicts) {
  while (!added.empty()) {
    std::vector<Correction> all = earlier;
    std::int32_t number = earlier.empty() ? 0 : earlier.back().number;
    for (Correction& c : added) c.number = ++number;
    all.insert(all.end(), added.begin(), added.end());
    const CorrectedMap map = apply_corrections(landmarks, next_id, all);
    std::vector<Correction> fitting;
    std::set<std::int32_t> not_added;
    for (std::size_t i = 0; i < added.size(); ++i) {
      const CorrectionResult& result = map.results[earlier.size() + i];
      const bool is_of_none = std::any_of(
          added[i].targets.begin(), added[i].targets.end(),
          [&](const CorrectionTarget& target) { return not_added.count(target.id) != 0; });
      if (is_of_none) continue;  // the cause is reported already
      if (result.outcome == CorrectionOutcome::kConflict) {
        conflicts.push_back(words_of(added[i]) + ": " + result.reason);
        if (added[i].new_id != 0) not_added.insert(added[i].new_id);
      } else if (result.outcome != CorrectionOutcome::kSatisfied) {
        fitting.push_back(added[i]);
      }
    }
    if (fitting.size() == added.size()) return fitting;
    added = std::move(fitting);
  }
  return added;
}

}  // namespace orchard::mapping
