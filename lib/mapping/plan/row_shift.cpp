// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/plan/row_shift.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr double kShiftedPrior = 3.9;   ///< log odds: one row in fifty is planted elsewhere
constexpr double kFarthestShift = 1.2;  ///< max shift along the row, in spacings
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

}  // namespace orchard::mapping
