// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/extent/stem_scatter.hpp"

#include <cmath>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

/// Minimum number of observations for a scatter.
constexpr int kObservationsMin = 10;
/// Quantile of the scatter of the trees of rows: one in twenty may have suckers or lean.
constexpr double kOfTrees = 0.95;

/// Standard deviation of single observations about their mean, per axis [m].
double scatter_m(const Landmark& l) {
  return std::sqrt(0.5 * l.num_observations * (l.se_x_m * l.se_x_m + l.se_y_m * l.se_y_m));
}

bool tells(const Landmark& l) {
  return l.label == detection::Label::kTree && l.num_observations >= kObservationsMin;
}

}  // namespace

StemScatterTest::StemScatterTest(const std::vector<Landmark>& landmarks) {
  std::vector<double> of_rows_m;
  for (const Landmark& l : landmarks) {
    if (l.row > 0 && tells(l)) of_rows_m.push_back(scatter_m(l));
  }
  scatter_max_m_ = geometry::quantile(std::move(of_rows_m), kOfTrees);
}

bool StemScatterTest::contains(const Landmark& landmark) const {
  return tells(landmark) && scatter_m(landmark) <= scatter_max_m_;
}

}  // namespace orchard::mapping
