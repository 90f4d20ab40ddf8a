// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/plan/plan_match.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/statistics.hpp"
#include "mapping/kind.hpp"
#include "mapping/plan/orchard_plan.hpp"

namespace orchard::mapping {
namespace {

std::vector<std::int32_t> numbers_of(const std::vector<std::string>& names) {
  std::vector<std::int32_t> numbers;
  for (const std::string& name : names) numbers.push_back(number_in_name(name));
  const std::set<std::int32_t> distinct(numbers.begin(), numbers.end());
  if (distinct.size() == names.size() && distinct.count(0) == 0) return numbers;
  for (std::size_t i = 0; i < names.size(); ++i) numbers[i] = static_cast<std::int32_t>(i) + 1;
  return numbers;
}

}  // namespace

PlanNames number_by_plan(const OrchardPlan& plan, const PlanMatch& match,
                         std::vector<Landmark>& landmarks) {
  std::vector<std::string> row_names;
  for (const PlannedRow& row : plan.rows) row_names.push_back(row.name);
  const std::vector<std::int32_t> row_numbers = numbers_of(row_names);
  std::vector<std::vector<std::int32_t>> tree_numbers;
  for (std::size_t r = 0; r < plan.rows.size(); ++r) {
    std::vector<std::string> tree_names;
    for (const PlannedTree& tree : plan.rows[r].trees) tree_names.push_back(tree.name);
    tree_numbers.push_back(numbers_of(tree_names));
  }
  for (Landmark& l : landmarks) l.row = l.position = 0;
  PlanNames names;
  for (const PlanFinding& f : match.findings) {
    if (f.deviation != PlanDeviation::kAsPlanned && f.deviation != PlanDeviation::kOutOfPlace) {
      continue;
    }
    const auto r = static_cast<std::size_t>(f.row), k = static_cast<std::size_t>(f.tree);
    Landmark& l = landmarks[static_cast<std::size_t>(f.landmark)];
    l.row = row_numbers[r];
    l.position = tree_numbers[r][k];
    names[l.id] = {plan.rows[r].name, plan.rows[r].trees[k].name};
  }
  return names;
}

RowNames plan_row_names(const std::vector<Landmark>& landmarks, const PlanNames& names) {
  RowNames row_names;
  for (const Landmark& l : landmarks) {
    const auto name = names.find(l.id);
    if (l.row == 0 || name == names.end() || name->second.row == std::to_string(l.row)) continue;
    row_names.emplace(l.row, name->second.row);
  }
  return row_names;
}

namespace {

using Eigen::Vector2d;

constexpr double kShiftedPrior = 3.9;  ///< derived: log odds: one row in fifty is planted elsewhere
constexpr double kFarthestShift = 1.2;  ///< derived: in spacings; farther is the next tree
/// derived: bounds the cost of a row of thousands of trees.
constexpr std::size_t kNumTriedMax = 400;

Vector2d aside_of(const Vector2d& along) { return {-along.y(), along.x()}; }

class RowShifter {
 public:
  RowShifter(const RegisteredRow& row, double spacing_m, const PlanNoise& noise,
             const MissProbability& missed)
      : row_(row),
        trees_(row.trees_map),
        spacing_m_(spacing_m),
        gate_m_(noise.gate_m),
        noise_(noise),
        missed_(missed) {}

  RowShift find() const {
    RowShift best = settled({});
    double best_log = log_likelihood(best);
    for (const RowShift& begin : to_try()) {
      const RowShift shift = settled(begin);
      const double log = log_likelihood(shift) - kShiftedPrior;
      if (log <= best_log) continue;
      best_log = log;
      best = shift;
    }
    return best;
  }

 private:
  Vector2d place(std::size_t k, const RowShift& s) const {
    return row_.places_map[k] + s.along_m * row_.along[k] + s.aside_m * aside_of(row_.along[k]);
  }

  /// Shifts that move a planned position onto a tree.
  std::vector<RowShift> to_try() const {
    std::vector<RowShift> shifts;
    const geometry::IndexedPoints places(row_.places_map);
    for (const Vector2d& tree : row_.trees_map) {
      for (const std::int32_t i : places.nearest_few(tree, 2.0 * spacing_m_, 4)) {
        const auto k = static_cast<std::size_t>(i);
        const Vector2d d = tree - row_.places_map[k];
        const double along_m = d.dot(row_.along[k]);
        if (std::abs(along_m) > kFarthestShift * spacing_m_) continue;
        shifts.push_back({along_m, d.dot(aside_of(row_.along[k])), 1});
      }
    }
    if (shifts.size() <= kNumTriedMax) return shifts;
    std::vector<RowShift> some;  // enough for a long row
    for (std::size_t k = 0; k < kNumTriedMax; ++k) {
      some.push_back(shifts[k * shifts.size() / kNumTriedMax]);
    }
    return some;
  }

  /// Iterates the shift to the median offset of the trees near the shifted positions.
  RowShift settled(RowShift shift) const {
    for (int round = 0; round < 3; ++round) {
      std::vector<double> along_m, aside_m;
      for (std::size_t k = 0; k < row_.places_map.size(); ++k) {
        const std::int32_t i = trees_.nearest(place(k, shift), gate_m_);
        if (i < 0) continue;
        const Vector2d d = trees_[static_cast<std::size_t>(i)] - row_.places_map[k];
        along_m.push_back(d.dot(row_.along[k]));
        aside_m.push_back(d.dot(aside_of(row_.along[k])));
      }
      if (along_m.empty()) return {shift.along_m, shift.aside_m, 0};
      shift.num_trees = static_cast<int>(along_m.size());
      shift.along_m = geometry::midpoint_median(std::move(along_m));
      shift.aside_m = geometry::midpoint_median(std::move(aside_m));
    }
    return shift;
  }

  double log_likelihood(const RowShift& shift) const {
    double log = 0.0;
    std::vector<bool> is_taken(trees_.size(), false);
    for (std::size_t k = 0; k < row_.places_map.size(); ++k) {
      const Vector2d p = place(k, shift);
      const std::int32_t i = trees_.nearest(p, gate_m_);
      if (i >= 0 && !is_taken[static_cast<std::size_t>(i)]) {
        is_taken[static_cast<std::size_t>(i)] = true;
        log += pair_gain((trees_[static_cast<std::size_t>(i)] - p).norm(), noise_);
      } else {
        log += missing_log_likelihood(missed_(p));
      }
    }
    return log;
  }

  const RegisteredRow& row_;
  geometry::IndexedPoints trees_;
  double spacing_m_;
  double gate_m_;
  const PlanNoise& noise_;
  const MissProbability& missed_;
};

}  // namespace

RowShift shift_of_row(const RegisteredRow& row, double spacing_m, const PlanNoise& noise,
                      const MissProbability& missed) {
  if (row.trees_map.empty() || row.places_map.empty()) return {};
  return RowShifter(row, spacing_m, noise, missed).find();
}

namespace {

constexpr double kPairReach = 0.45;  ///< derived: of the spacing; excludes neighbouring positions
constexpr double kSeenConfidence = 0.8;  ///< derived: same as for missing trees of two maps
/// derived: one tree in 3,000 by chance (exp(-8)).
constexpr double kOutOfPlaceSigmas = 4.0;
constexpr int kNeighbourRows = 3;   ///< derived: on each side; they share the map's deformation
constexpr int kNeighbourTrees = 5;  ///< derived: along a row, on each side; likewise

Vector2d left_of(const Vector2d& along) { return {-along.y(), along.x()}; }

class PlanMatcher {
 public:
  PlanMatcher(const OrchardPlan& plan, const std::vector<Landmark>& landmarks,
              const DetectionMap& view, const PlanMatchConfig& config)
      : plan_(plan),
        landmarks_(landmarks),
        config_(config),
        indices_(plan_indices(plan)),
        planned_(plan.places()),
        mapped_({}),
        objects_({}) {
    std::vector<Vector2d> trees, objects;
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const bool is_object = !may_be_tree(landmarks[i]);
      (is_object ? objects : trees).push_back({landmarks[i].x_m, landmarks[i].y_m});
      (is_object ? object_index_ : tree_index_).push_back(static_cast<std::int32_t>(i));
    }
    mapped_ = geometry::IndexedPoints(std::move(trees));
    objects_ = geometry::IndexedPoints(std::move(objects));
    spacing_m_ = geometry::typical_spacing_m(planned_);
    aisle_m_ = typical_aisle_m(plan);
    if (aisle_m_ <= 0.0) aisle_m_ = 2.0 * spacing_m_;
    if (view.is_known()) {
      missed_ = view.probability_missed_anywhere();
    } else {
      // Without a detection map, the ground near mapped trees counts as observed.
      const double near_m = 1.5 * std::max(spacing_m_, aisle_m_);
      missed_ = [this, near_m](const Vector2d& p) {
        return mapped_.nearest(p, near_m) >= 0 ? 0.0 : 1.0;
      };
    }
  }

  PlanMatch match() {
    PlanMatch match;
    match.fit = fit_plan(mapped_, planned_, missed_, config_.alignment);
    if (match.fit.placements.empty()) return match;
    const bool is_chosen = config_.placement > 0;
    if (match.fit.status == AlignmentStatus::kAmbiguous && !is_chosen) return match;
    match.placement = is_chosen ? static_cast<std::size_t>(config_.placement) - 1 : 0;
    if (match.placement >= match.fit.placements.size()) {
      match.fit.reason = "there is no placement " + std::to_string(config_.placement) + ", only " +
                         std::to_string(match.fit.placements.size());
      return match;
    }
    register_plan(match.T_map_plan());
    match.rows.resize(plan_.rows.size());
    shift_rows(match);
    find_trees(match);
    find_extra(match);
    count(match);
    return match;
  }

 private:
  void register_plan(const geometry::Pose2& T) {
    for (const Vector2d& p : planned_.points()) places_.push_back(transform(T, p));
    for (const Vector2d& u : directions_along_rows(plan_)) {
      along_.push_back(geometry::rotation(T) * u);
    }
  }

  /// Index of the planned position nearest to a point; -1 if it is too far from any row.
  std::int32_t nearest_place(const geometry::IndexedPoints& places, const Vector2d& p) const {
    return places.nearest(p, std::max(aisle_m_, 2.0 * spacing_m_));
  }

  void shift_rows(PlanMatch& match) {
    noise_ = match.fit.noise;
    noise_.gate_m = kPairReach * spacing_m_;
    const geometry::IndexedPoints places(places_);
    std::vector<RegisteredRow> laid(plan_.rows.size());
    for (std::size_t i = 0; i < places_.size(); ++i) {
      RegisteredRow& row = laid[static_cast<std::size_t>(indices_[i].row)];
      row.places_map.push_back(places_[i]);
      row.along.push_back(along_[i]);
    }
    for (const Vector2d& tree : mapped_.points()) {
      const std::int32_t i = nearest_place(places, tree);
      if (i < 0) continue;
      laid[static_cast<std::size_t>(indices_[static_cast<std::size_t>(i)].row)].trees_map.push_back(
          tree);
    }
    for (std::size_t r = 0; r < laid.size(); ++r) {
      match.rows[r].shift = shift_of_row(laid[r], spacing_m_, noise_, missed_);
    }
    for (std::size_t r = 0; r < laid.size(); ++r) {
      const RowShift usual = median_shift(match, r);
      const RowShift& own = match.rows[r].shift;
      match.rows[r].is_shifted =
          own.num_trees >= 2 && std::hypot(own.along_m - usual.along_m,
                                           own.aside_m - usual.aside_m) > config_.tolerance_m;
    }
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const RowShift& s = match.rows[static_cast<std::size_t>(indices_[i].row)].shift;
      shifted_.push_back(places_[i] + s.along_m * along_[i] + s.aside_m * left_of(along_[i]));
    }
  }

  /// Median shift of the neighbouring rows, which is caused by deformation of the map.
  RowShift median_shift(const PlanMatch& match, std::size_t r) const {
    std::vector<double> along_m, aside_m;
    const auto num = static_cast<int>(plan_.rows.size());
    for (int k = static_cast<int>(r) - kNeighbourRows; k <= static_cast<int>(r) + kNeighbourRows;
         ++k) {
      if (k < 0 || k >= num || k == static_cast<int>(r)) continue;
      const RowShift& s = match.rows[static_cast<std::size_t>(k)].shift;
      if (s.num_trees < 2) continue;
      along_m.push_back(s.along_m);
      aside_m.push_back(s.aside_m);
    }
    return {geometry::midpoint_median(std::move(along_m)),
            geometry::midpoint_median(std::move(aside_m)), 0};
  }

  void find_trees(PlanMatch& match) {
    const geometry::IndexedPoints shifted(shifted_);
    partner_.assign(places_.size(), -1);
    is_paired_.assign(mapped_.size(), false);
    for (const LandmarkPair& pair :
         pair_landmarks(mapped_, shifted, geometry::Pose2{}, noise_.gate_m)) {
      partner_[static_cast<std::size_t>(pair.b)] = pair.a;
      is_paired_[static_cast<std::size_t>(pair.a)] = true;
    }
    const std::vector<double> off_m = off_row_m();
    const double farthest_m =
        std::max(config_.tolerance_m, kOutOfPlaceSigmas * geometry::robust_sd(off_m) / kRayleigh);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      PlanFinding f;
      f.row = indices_[i].row;
      f.tree = indices_[i].tree;
      if (partner_[i] >= 0) {
        const auto tree = static_cast<std::size_t>(partner_[i]);
        f.landmark = tree_index_[tree];
        f.p_map = mapped_[tree];
        const Vector2d d = f.p_map - places_[i];
        f.along_m = d.dot(along_[i]);
        f.aside_m = d.dot(left_of(along_[i]));
        f.confidence = 1.0;
        if (off_m[i] > farthest_m) f.deviation = PlanDeviation::kOutOfPlace;
      } else {
        f.p_map = shifted_[i];
        f.confidence = 1.0 - missed_(f.p_map);
        f.deviation =
            f.confidence >= kSeenConfidence ? PlanDeviation::kMissing : PlanDeviation::kNotSeen;
        const std::int32_t object = objects_.nearest(f.p_map, config_.tolerance_m);
        if (object >= 0) f.landmark = object_index_[static_cast<std::size_t>(object)];
      }
      match.findings.push_back(f);
    }
    double sum_m2 = 0.0;
    int num = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (partner_[i] < 0 || match.rows[static_cast<std::size_t>(indices_[i].row)].is_shifted) {
        continue;
      }
      sum_m2 += (mapped_[static_cast<std::size_t>(partner_[i])] - places_[i]).squaredNorm();
      ++num;
    }
    match.rms_m = num > 0 ? std::sqrt(sum_m2 / num) : 0.0;
  }

  /// Distance of each tree from its position in the shifted row, minus the common offset of its
  /// neighbours along the row [m]; 0 without tree.
  std::vector<double> off_row_m() const {
    std::vector<double> off_m(places_.size(), 0.0);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (partner_[i] < 0) continue;
      std::vector<double> x_m, y_m;
      for (int k = -kNeighbourTrees; k <= kNeighbourTrees; ++k) {
        const auto j = static_cast<std::size_t>(static_cast<std::int64_t>(i) + k);
        if (k == 0 || j >= places_.size() || indices_[j].row != indices_[i].row) continue;
        if (partner_[j] < 0) continue;
        const Vector2d d = mapped_[static_cast<std::size_t>(partner_[j])] - shifted_[j];
        x_m.push_back(d.x());
        y_m.push_back(d.y());
      }
      const Vector2d common(geometry::midpoint_median(std::move(x_m)),
                            geometry::midpoint_median(std::move(y_m)));
      const Vector2d own = mapped_[static_cast<std::size_t>(partner_[i])] - shifted_[i];
      off_m[i] = (own - common).norm();
    }
    return off_m;
  }

  void find_extra(PlanMatch& match) {
    const geometry::IndexedPoints shifted(shifted_);
    for (std::size_t k = 0; k < mapped_.size(); ++k) {
      if (is_paired_[k]) continue;
      PlanFinding f;
      f.deviation = PlanDeviation::kExtra;
      f.landmark = tree_index_[k];
      f.p_map = mapped_[k];
      f.confidence = 1.0;
      const std::int32_t i = nearest_place(shifted, f.p_map);
      if (i >= 0) {
        const auto at = static_cast<std::size_t>(i);
        const Vector2d d = f.p_map - shifted_[at];
        if (std::abs(d.dot(left_of(along_[at]))) <= 0.25 * aisle_m_) {
          f.row = indices_[at].row;
          f.tree = indices_[at].tree - (d.dot(along_[at]) < 0.0 ? 1 : 0);
        }
      }
      match.findings.push_back(f);
    }
  }

  static void count(PlanMatch& match) {
    for (const PlanFinding& f : match.findings) {
      const auto kind = static_cast<std::size_t>(f.deviation);
      ++match.counts[kind];
      if (f.row >= 0) ++match.rows[static_cast<std::size_t>(f.row)].counts[kind];
    }
  }

  /// derived: Median length of a vector with normal components, relative to what robust_sd()
  /// returns for it.
  static constexpr double kRayleigh = 1.1774 * geometry::kMadToSd;

  const OrchardPlan& plan_;
  const std::vector<Landmark>& landmarks_;
  const PlanMatchConfig& config_;
  std::vector<PlanIndex> indices_;
  geometry::IndexedPoints planned_;
  geometry::IndexedPoints mapped_;
  geometry::IndexedPoints objects_;
  std::vector<std::int32_t> tree_index_, object_index_;  ///< into landmarks_
  double spacing_m_ = 0.0;
  double aisle_m_ = 0.0;
  MissProbability missed_;
  PlanNoise noise_;
  std::vector<Vector2d> places_;   ///< planned positions in map
  std::vector<Vector2d> along_;    ///< directions of their rows in map
  std::vector<Vector2d> shifted_;  ///< planned positions including the shifts of their rows
  std::vector<std::int32_t> partner_;
  std::vector<bool> is_paired_;
};

}  // namespace

const char* deviation_text(PlanDeviation deviation) {
  switch (deviation) {
    case PlanDeviation::kAsPlanned:
      return "as_planned";
    case PlanDeviation::kOutOfPlace:
      return "out_of_place";
    case PlanDeviation::kMissing:
      return "missing";
    case PlanDeviation::kNotSeen:
      return "not_seen";
    case PlanDeviation::kExtra:
      break;
  }
  return "extra";
}

PlanMatch match_plan(const OrchardPlan& plan, const std::vector<Landmark>& landmarks,
                     const DetectionMap& view, const PlanMatchConfig& config) {
  return PlanMatcher(plan, landmarks, view, config).match();
}

}  // namespace orchard::mapping
