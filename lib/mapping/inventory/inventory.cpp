// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/inventory/inventory.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "mapping/rows/row_numbers.hpp"

namespace orchard::mapping {

GrowthByRow growth_by_row(const std::vector<Landmark>& earlier, const std::vector<Landmark>& later,
                          const MapComparison& comparison) {
  const KindCounts kinds(later);
  GrowthByRow growth;
  growth[kGrowthOfAll];
  for (const MapChange& change : comparison.changes) {
    if (change.a < 0 || change.b < 0) continue;
    const Landmark& before = earlier.at(static_cast<std::size_t>(change.a));
    const Landmark& now = later.at(static_cast<std::size_t>(change.b));
    const bool are_trees =
        before.label == detection::Label::kTree && now.label == detection::Label::kTree;
    if (!are_trees || !(before.width_m > 0.0) || !(now.width_m > 0.0)) continue;
    const double before_cm2 = tcsa_cm2(before.width_m);
    const double change_cm2 = tcsa_cm2(now.width_m) - before_cm2;
    for (const std::int32_t row : {now.row, kGrowthOfAll}) {
      if (row == kGrowthOfAll && !kinds.counts(kind_of(now))) continue;
      Growth& sum = growth[row];
      ++sum.num_pairs;
      sum.tcsa_before_cm2 += before_cm2;
      sum.tcsa_change_cm2 += change_cm2;
    }
  }
  return growth;
}

namespace {

/// derived: probabilities as they are reported.
constexpr double kSure = 0.95, kLikely = 0.8;
constexpr int kClassesMax = 40;
/// derived: heights of trees come from the way within some metres, and share what is wrong with it.
constexpr double kSharedHeight_m = 8.0;

/// Sums over trunks.
struct Sum {
  void add(const Landmark& l) {
    ++row.num_trees;
    if (!(l.width_m > 0.0)) return;
    ++row.num_measured;
    diameters_m += l.width_m;
    row.tcsa_cm2 += tcsa_cm2(l.width_m);
    // d(pi/4 d^2) = pi/2 d dd
    const double sd_cm2 = 1e4 * 0.5 * geometry::kPi * l.width_m * l.width_sd_m;
    variance_cm4 += sd_cm2 * sd_cm2;
  }
  RowInventory done() {
    if (row.num_measured > 0) row.diameter_mean_m = diameters_m / row.num_measured;
    row.tcsa_sd_cm2 = std::sqrt(variance_cm4);
    return row;
  }
  RowInventory row;
  double diameters_m = 0.0, variance_cm4 = 0.0;
};

void add_slots(const Row& slots, RowInventory& row) {
  for (const RowSlot& slot : slots.places) {
    if (slot.position == 0) continue;
    if (row.first_position == 0) row.first_position = slot.position;
    row.last_position = slot.position;
    if (slot.landmark_id == 0) row.gaps.push_back({slot.position, slot.p_map});
  }
}

}  // namespace

double tcsa_cm2(double diameter_m) {
  const double diameter_cm = 100.0 * diameter_m;
  return 0.25 * geometry::kPi * diameter_cm * diameter_cm;
}

std::optional<RowSlope> row_slope(const std::vector<Landmark>& trees) {
  // Along the row, which may be curved; both relative to the first height.
  double along_m = 0.0, sum = 0.0, sum_s = 0.0, sum_z = 0.0, sum_ss = 0.0, sum_sz = 0.0;
  const Landmark* first = nullptr;
  int num = 0;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const Landmark& l = trees[i];
    if (i > 0) along_m += std::hypot(l.x_m - trees[i - 1].x_m, l.y_m - trees[i - 1].y_m);
    if (!(l.z_sd_m > 0.0)) continue;
    if (first == nullptr) first = &l;
    const double weight = 1.0 / (l.z_sd_m * l.z_sd_m), z_m = l.z_m - first->z_m;
    sum += weight, sum_s += weight * along_m, sum_z += weight * z_m;
    sum_ss += weight * along_m * along_m, sum_sz += weight * along_m * z_m;
    ++num;
  }
  const double spread_m2 = sum_ss - sum_s * sum_s / std::max(sum, 1e-12);
  if (num < 3 || !(spread_m2 > 0.0)) return std::nullopt;
  const double slope = (sum_sz - sum_s * sum_z / sum) / spread_m2;
  const double num_independent = std::min<double>(num, 1.0 + along_m / kSharedHeight_m);
  const double slope_sd = std::sqrt(num / (num_independent * spread_m2));
  return RowSlope{100.0 * slope, 100.0 * slope_sd, slope * along_m};
}

bool has_slopes(const Inventory& inventory) {
  return std::any_of(inventory.rows.begin(), inventory.rows.end(),
                     [](const RowInventory& row) { return row.slope.has_value(); });
}

Inventory compute_inventory(const std::vector<Landmark>& landmarks) {
  Inventory inventory;
  inventory.kinds = KindCounts(landmarks);
  std::map<std::int32_t, Sum> rows;
  std::map<std::int32_t, std::map<std::int32_t, Landmark>> trees_of;  // by row and position
  Sum all, other;
  std::vector<double> position_se_m, width_sd_m;
  for (const Landmark& l : landmarks) {
    const Kind kind = kind_of(l);
    if (kind == Kind::kTree) rows[l.row].add(l);
    if (kind == Kind::kTree && l.position > 0) trees_of[l.row].emplace(l.position, l);
    if (kind == Kind::kTrunk && inventory.kinds.has_rows()) other.add(l);
    if (!inventory.kinds.counts(kind)) continue;
    all.add(l);
    CertaintyCounts& certainty = inventory.certainty;
    ++(l.probability >= kSure     ? certainty.num_sure
       : l.probability >= kLikely ? certainty.num_likely
                                  : certainty.num_unsure);
    position_se_m.push_back(std::max(l.se_x_m, l.se_y_m));
    if (l.width_sd_m > 0.0) width_sd_m.push_back(l.width_sd_m);
  }
  inventory.all = all.done();
  inventory.other = other.done();
  for (const Row& slots : numbered_rows(landmarks)) {
    RowInventory row = rows.at(slots.number).done();
    row.row = slots.number;
    add_slots(slots, row);
    std::vector<Landmark> trees;
    for (const auto& [position, l] : trees_of[slots.number]) trees.push_back(l);
    row.slope = row_slope(trees);
    inventory.all.gaps.insert(inventory.all.gaps.end(), row.gaps.begin(), row.gaps.end());
    inventory.rows.push_back(std::move(row));
  }
  if (!position_se_m.empty()) inventory.position_se_median_m = geometry::median(position_se_m);
  if (!width_sd_m.empty()) inventory.width_sd_median_m = geometry::median(width_sd_m);
  return inventory;
}

DiameterHistogram diameter_histogram(const std::vector<Landmark>& landmarks) {
  std::vector<double> diameters_m;
  for (const Landmark& l : counted_trunks(landmarks)) {
    if (l.width_m > 0.0 && std::isfinite(l.width_m)) diameters_m.push_back(l.width_m);
  }
  DiameterHistogram histogram;
  if (diameters_m.empty()) return histogram;
  std::sort(diameters_m.begin(), diameters_m.end());
  // A few very wide trunks do not widen the classes.
  const double wide_m = diameters_m[(diameters_m.size() - 1) * 98 / 100];
  while (wide_m > kClassesMax * histogram.class_m) histogram.class_m *= 2.0;
  const auto class_of = [&](double diameter_m) {
    return static_cast<std::size_t>(
        std::min<double>(kClassesMax, std::floor(diameter_m / histogram.class_m)));
  };
  histogram.counts.resize(class_of(diameters_m.back()) + 1);
  for (const double diameter_m : diameters_m) ++histogram.counts[class_of(diameter_m)];
  return histogram;
}

}  // namespace orchard::mapping
