// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/corrections/apply_corrections.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "detection/detection.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/compare/map_merging.hpp"
#include "pose/attitude/attitude.hpp"
#include "text/number_text.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;
using Eigen::Vector2d;
using Outcome = CorrectionOutcome;

Vector2d place_of(const Landmark& l) { return {l.x_m, l.y_m}; }

bool is_alike(const CorrectionTarget& target, const Landmark& l) {
  if (l.label != target.label) return false;
  if (l.width_m <= 0.0 || target.width_m <= 0.0) return true;
  const double ratio = l.width_m / target.width_m;
  return ratio <= kLikeWidth && ratio >= 1.0 / kLikeWidth;
}

/// Applies corrections one by one to a map.
class Applier {
 public:
  Applier(const std::vector<Landmark>& landmarks, std::int32_t next_id,
          std::map<std::int32_t, std::string> row_names)
      : reach_m_(pairing_gate_m(geometry::IndexedPoints(landmark_positions(landmarks)))),
        next_id_(std::max(1, next_id)),
        row_names_(std::move(row_names)) {
    for (const Landmark& l : landmarks) {
      put(l);
      if (l.row != 0) rows_.insert(l.row);
    }
  }

  CorrectionResult apply(const Correction& c) {
    result_ = {c.number, Outcome::kApplied, {}};
    if (c.new_id != 0) next_id_ = std::max(next_id_, c.new_id + 1);
    switch (c.kind) {
      case CorrectionKind::kDelete:
        if (const auto id = find_or_gone(c.targets.at(0))) landmarks_.erase(*id);
        break;
      case CorrectionKind::kAdd:
        add(c);
        break;
      case CorrectionKind::kMove:
        if (Landmark* l = find(c.targets.at(0))) move(*l, c.places_map.at(0));
        break;
      case CorrectionKind::kClass:
        if (Landmark* l = find(c.targets.at(0))) set_class(c.label, *l);
        break;
      case CorrectionKind::kMerge:
        merge(c);
        break;
      case CorrectionKind::kSplit:
        split(c);
        break;
      case CorrectionKind::kRowName:
        name_row(c);
        break;
      case CorrectionKind::kRenumber:
        renumber(c);
        break;
      case CorrectionKind::kNote:
        if (const Landmark* l = find(c.targets.at(0))) notes_[l->id].push_back(c.note);
        break;
      case CorrectionKind::kUndo:
      case CorrectionKind::kRedo:
        break;
    }
    return result_;
  }

  /// Records the positions of an undone correction, because later corrections may refer to them.
  void remember(const Correction& c) {
    if (c.new_id != 0) next_id_ = std::max(next_id_, c.new_id + 1);
    if (c.targets.empty() || c.places_map.empty()) return;
    places_[c.targets.front().id].push_back(c.places_map.front());
  }

  CorrectedMap finish() {
    CorrectedMap map;
    for (const auto& [id, l] : landmarks_) map.landmarks.push_back(l);
    for (const auto& [id, texts] : notes_) {
      if (landmarks_.count(id) != 0) map.notes[id] = texts;
    }
    map.row_names = row_names_;
    map.next_id = next_id_;
    return map;
  }

 private:
  void put(const Landmark& l) {
    landmarks_[l.id] = l;
    places_[l.id].push_back(place_of(l));
    next_id_ = std::max(next_id_, l.id < INT32_MAX ? l.id + 1 : l.id);
  }

  void move(Landmark& l, const Vector2d& p) {
    if (l.z_sd_m > 0.0) {
      l.z_sd_m = std::hypot(l.z_sd_m, pose::kDrivenSlopeSd * (p - place_of(l)).norm());
    }
    l.x_m = p.x(), l.y_m = p.y();
    l.se_x_m = l.se_y_m = 0.0;
    places_[l.id].push_back(p);
  }

  Landmark* conflict(std::string reason) {
    result_.outcome = Outcome::kConflict;
    result_.reason = std::move(reason);
    return nullptr;
  }

  /// The nearest landmark within reach that satisfies `accepts`; nullptr if there is none.
  template <class Accepts>
  Landmark* nearest(const Vector2d& p, const Accepts& accepts) {
    Landmark* best = nullptr;
    double best_m = reach_m_;
    for (auto& [id, l] : landmarks_) {
      const double away_m = (place_of(l) - p).norm();
      if (away_m > best_m || !accepts(l)) continue;
      best = &l, best_m = away_m;
    }
    return best;
  }
  Landmark* nearest(const Vector2d& p) {
    return nearest(p, [](const Landmark&) { return true; });
  }

  std::int32_t known_as(std::int32_t id) const {
    const auto found = other_id_.find(id);
    return found == other_id_.end() ? id : found->second;
  }

  Landmark* by_id(const CorrectionTarget& target) {
    const auto found = landmarks_.find(known_as(target.id));
    if (found == landmarks_.end()) return nullptr;
    const std::vector<Vector2d>& places = places_[found->first];
    const bool is_near = std::any_of(places.begin(), places.end(), [&](const Vector2d& p) {
      return (p - target.p_map).norm() <= reach_m_;
    });
    return is_near ? &found->second : nullptr;
  }

  Landmark* by_place(const CorrectionTarget& target) {
    Landmark* l = nearest(target.p_map, [&](const Landmark& x) { return is_alike(target, x); });
    if (l == nullptr) return nullptr;
    result_.outcome = Outcome::kByPlace;
    result_.reason = std::to_string(l->id) + " is at the position of " + std::to_string(target.id);
    other_id_[target.id] = l->id;
    return l;
  }

  /// Explains why a target was not found.
  std::string lost(const CorrectionTarget& target) {
    const std::string name = std::to_string(target.id);
    const auto found = landmarks_.find(known_as(target.id));
    if (found != landmarks_.end()) {
      return name + " is " + fixed_text((place_of(found->second) - target.p_map).norm(), 2) +
             " m from the position of the correction";
    }
    const Landmark* l = nearest(target.p_map);
    if (l == nullptr) return name + " is gone, and no landmark is at its position";
    return name + " is gone; " + std::to_string(l->id) + ", " + label_text(l->label) + " " +
           fixed_text(l->width_m, 2) + " m wide, is at its position now";
  }

  Landmark* find(const CorrectionTarget& target) {
    if (Landmark* l = by_id(target)) return l;
    if (Landmark* l = by_place(target)) return l;
    return conflict(lost(target));
  }

  /// The id to delete; none if nothing exists there (the correction is satisfied) or if it is a
  /// conflict.
  std::optional<std::int32_t> find_or_gone(const CorrectionTarget& target) {
    const bool is_gone =
        landmarks_.count(known_as(target.id)) == 0 && nearest(target.p_map) == nullptr;
    if (is_gone) {
      result_ = {result_.number, Outcome::kSatisfied,
                 "the map has no landmark there: " + std::to_string(target.id) + " is gone"};
      return std::nullopt;
    }
    const Landmark* l = find(target);
    return l ? std::optional<std::int32_t>(l->id) : std::nullopt;
  }

  /// An id for a new landmark: the wanted one, or the next free one if that is in use.
  std::int32_t free_id(std::int32_t wanted) {
    if (landmarks_.count(wanted) == 0) return wanted;
    const std::int32_t id = next_id_;
    other_id_[wanted] = id;
    result_ = {result_.number, Outcome::kByPlace,
               std::to_string(wanted) + " is the id of another landmark now; this one got id " +
                   std::to_string(id)};
    return id;
  }

  void set_class(Label label, Landmark& l) {
    l.label = label;
    if (label == Label::kUnseen) return;
    // A person's class is certain; rows are found from certain trees.
    l.probability = l.roc_mean = label == Label::kTree ? 1.0 : 0.0;
    if (label != Label::kTree) l.row = l.position = 0;
  }

  void add(const Correction& c) {
    const Vector2d& p = c.places_map.at(0);
    if (const Landmark* l = nearest(p)) {
      if (l->label != c.label) {
        conflict(std::to_string(l->id) + ", " + label_text(l->label) + ", is there already");
        return;
      }
      if (l->id != c.new_id) other_id_[c.new_id] = l->id;
      result_ = {c.number, Outcome::kSatisfied,
                 "the map has it already, with id " + std::to_string(l->id)};
      return;
    }
    Landmark l;
    l.id = free_id(c.new_id);
    set_class(c.label, l);
    l.width_m = c.width_m;
    l.x_m = p.x(), l.y_m = p.y();
    put(l);
  }

  void merge(const Correction& c) {
    std::vector<Landmark*> parts;
    std::string gone;
    for (const CorrectionTarget& target : c.targets) {
      Landmark* l = find(target);
      if (l == nullptr) {
        gone = result_.reason;
      } else if (std::find(parts.begin(), parts.end(), l) == parts.end()) {
        parts.push_back(l);
      }
    }
    if (parts.empty()) return;  // the conflict is that of the last target
    if (parts.size() == 1) {
      result_ = {c.number, Outcome::kSatisfied,
                 "the map has only one landmark there: " + std::to_string(parts[0]->id)};
      return;
    }
    if (result_.outcome == Outcome::kConflict) {
      result_ = {c.number, Outcome::kByPlace, "one of them was left out: " + gone};
    }
    Landmark whole = *parts[0];
    for (std::size_t i = 1; i < parts.size(); ++i) {
      Landmark part = *parts[i];
      if (part.width_m <= 0.0) part.width_m = whole.width_m;
      if (whole.width_m <= 0.0) whole.width_m = part.width_m;
      whole = merged_landmark(whole, part);
      if (whole.row == 0) whole.row = part.row, whole.position = part.position;
      for (const std::string& text : notes_[part.id]) notes_[whole.id].push_back(text);
      notes_.erase(part.id);
      other_id_[part.id] = whole.id;
      landmarks_.erase(part.id);
    }
    whole.x_m = c.places_map.at(0).x(), whole.y_m = c.places_map.at(0).y();
    places_[whole.id].push_back(c.places_map.at(0));
    landmarks_[whole.id] = whole;
  }

  void split(const Correction& c) {
    const CorrectionTarget& target = c.targets.at(0);
    const Landmark* first = nearest(c.places_map.at(0));
    const Landmark* second = nearest(c.places_map.at(1));
    if (first != nullptr && second != nullptr && first != second) {
      if (second->id != c.new_id) other_id_[c.new_id] = second->id;
      if (landmarks_.count(target.id) == 0) other_id_[target.id] = first->id;
      result_ = {c.number, Outcome::kSatisfied,
                 "the map has two landmarks there: " + std::to_string(first->id) + " and " +
                     std::to_string(second->id)};
      return;
    }
    Landmark* l = find(target);
    if (l == nullptr) return;
    l->width_m = l->width_sd_m = 0.0;  // the width of both together does not apply to one
    l->num_observations = (l->num_observations + 1) / 2;
    Landmark other = *l;
    move(*l, c.places_map.at(0));
    other.id = free_id(c.new_id);
    other.row = other.position = 0;
    other.x_m = c.places_map.at(1).x(), other.y_m = c.places_map.at(1).y();
    other.se_x_m = other.se_y_m = 0.0;
    put(other);
  }

  void name_row(const Correction& c) {
    if (rows_.count(c.row) == 0) {
      conflict("there is no row " + std::to_string(c.row));
      return;
    }
    for (const auto& [row, name] : row_names_) {
      if (row == c.row || name != c.name) continue;
      conflict("row " + std::to_string(row) + " already has the name \"" + c.name + "\"");
      return;
    }
    row_names_[c.row] = c.name;
  }

  void renumber(const Correction& c) {
    Landmark* l = find(c.targets.at(0));
    if (l == nullptr) return;
    for (const auto& [id, other] : landmarks_) {
      if (&other == l || c.position == 0) continue;
      if (other.row != c.row || other.position != c.position) continue;
      conflict("row " + std::to_string(c.row) + " tree " + std::to_string(c.position) +
               " is already landmark " + std::to_string(id));
      return;
    }
    l->row = c.row, l->position = c.position;
    rows_.insert(c.row);
  }

  double reach_m_;
  std::int32_t next_id_;
  std::map<std::int32_t, Landmark> landmarks_;
  std::map<std::int32_t, std::vector<Vector2d>> places_;  ///< all positions that a landmark has had
  std::map<std::int32_t, std::int32_t> other_id_;         ///< id in corrections -> id in the map
  std::map<std::int32_t, std::string> row_names_;
  std::map<std::int32_t, std::vector<std::string>> notes_;
  std::set<std::int32_t> rows_;
  CorrectionResult result_;
};

}  // namespace

int CorrectedMap::count(CorrectionOutcome outcome) const {
  return static_cast<int>(std::count_if(
      results.begin(), results.end(),
      [outcome](const CorrectionResult& result) { return result.outcome == outcome; }));
}

CorrectedMap apply_corrections(const std::vector<Landmark>& landmarks, std::int32_t next_id,
                               const std::vector<Correction>& corrections,
                               std::map<std::int32_t, std::string> row_names) {
  Applier applier(landmarks, next_id, std::move(row_names));
  const std::vector<bool> holds = corrections_that_hold(corrections);
  std::vector<CorrectionResult> results;
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    const Correction& c = corrections[i];
    const bool is_step = c.kind == CorrectionKind::kUndo || c.kind == CorrectionKind::kRedo;
    if (holds[i] || is_step) {
      results.push_back(applier.apply(c));
    } else {
      applier.remember(c);
      results.push_back({c.number, Outcome::kUndone, {}});
    }
  }
  CorrectedMap map = applier.finish();
  map.results = std::move(results);
  return map;
}

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

namespace {

using geometry::Pose2;

/// Local deformation of the new map against the rigid alignment, from landmarks known in both.
class Bend {
 public:
  Bend(const std::vector<Landmark>& earlier, const std::vector<Landmark>& now,
       const Pose2& T_earlier_now)
      : T_earlier_now_(T_earlier_now), known_(known_of(earlier, now)) {}

  Vector2d now(const Vector2d& p_earlier) const {
    // derived: as for the residuals around a pair (landmark_pairing.cpp).
    constexpr std::size_t kNumNeighbours = 9;
    constexpr double kReach_m = 25.0;
    std::vector<double> x_m, y_m;
    for (const std::int32_t i : known_.nearest_few(p_earlier, kReach_m, kNumNeighbours)) {
      const Vector2d shift_m = shifts_m_[static_cast<std::size_t>(i)];
      x_m.push_back(shift_m.x());
      y_m.push_back(shift_m.y());
    }
    Vector2d p = inverse_transform(T_earlier_now_, p_earlier);
    if (!x_m.empty()) p += Vector2d(geometry::median(x_m), geometry::median(y_m));
    return p;
  }

 private:
  geometry::IndexedPoints known_of(const std::vector<Landmark>& earlier,
                                   const std::vector<Landmark>& now) {
    std::map<std::int32_t, Vector2d> places_now;
    for (const Landmark& l : now) places_now[l.id] = {l.x_m, l.y_m};
    std::vector<Vector2d> places;
    for (const Landmark& l : earlier) {
      const auto found = places_now.find(l.id);
      if (found == places_now.end()) continue;
      const Vector2d p_earlier(l.x_m, l.y_m);
      places.push_back(p_earlier);
      shifts_m_.push_back(found->second - inverse_transform(T_earlier_now_, p_earlier));
    }
    return geometry::IndexedPoints(std::move(places));
  }

  Pose2 T_earlier_now_;
  std::vector<Vector2d> shifts_m_;
  geometry::IndexedPoints known_;
};

}  // namespace

std::vector<Landmark> known_landmarks(const std::vector<Landmark>& earlier,
                                      const std::vector<Landmark>& corrected) {
  std::map<std::int32_t, bool> is_mapped;
  for (const Landmark& l : earlier) is_mapped[l.id] = true;
  std::vector<Landmark> known = earlier;
  for (const Landmark& l : corrected) {
    if (is_mapped.count(l.id) == 0) known.push_back(l);
  }
  return known;
}

std::vector<Correction> carry_corrections(const std::vector<Correction>& corrections,
                                          const std::vector<Landmark>& earlier,
                                          const std::vector<Landmark>& now,
                                          const Pose2& T_earlier_now) {
  const Bend bend(earlier, now, T_earlier_now);
  std::map<std::int32_t, const Landmark*> then, found_again;
  for (const Landmark& l : earlier) then[l.id] = &l;
  for (const Landmark& l : now) found_again[l.id] = &l;
  std::vector<Correction> carried = corrections;
  for (Correction& c : carried) {
    for (CorrectionTarget& target : c.targets) {
      constexpr double kSame_m = 0.002;  // derived: files are rounded to 0.1 mm
      const auto before = then.find(target.id);
      const auto after = found_again.find(target.id);
      const bool is_as_mapped =
          before != then.end() && after != found_again.end() &&
          (Vector2d(before->second->x_m, before->second->y_m) - target.p_map).norm() < kSame_m;
      target.p_map =
          is_as_mapped ? Vector2d(after->second->x_m, after->second->y_m) : bend.now(target.p_map);
    }
    for (Vector2d& p : c.places_map) p = bend.now(p);
  }
  return carried;
}

}  // namespace orchard::mapping
