// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_slots.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Steps on either side that determine the local spacing.
constexpr std::size_t kSpacingWindow = 15;
/// Trees at the start of a row that are compared with the neighbouring row.
constexpr std::size_t kNumCompared = 4;
/// Rows on either side that determine where a row should start.
constexpr int kRowsAround = 8;

/// Spacing around step k.
double local_spacing_m(const std::vector<double>& steps_m, std::size_t k) {
  const std::size_t first = k > kSpacingWindow ? k - kSpacingWindow : 0;
  const std::size_t last = std::min(steps_m.size(), k + kSpacingWindow + 1);
  return single_step_m({steps_m.begin() + static_cast<std::ptrdiff_t>(first),
                        steps_m.begin() + static_cast<std::ptrdiff_t>(last)});
}

std::vector<int> places_within(const std::vector<Vector2d>& p_map, const RowChain& chain) {
  std::vector<double> steps_m;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    steps_m.push_back(
        (p_map[static_cast<std::size_t>(chain[i])] - p_map[static_cast<std::size_t>(chain[i - 1])])
            .norm());
  }
  std::vector<int> places{0};
  for (std::size_t k = 0; k < steps_m.size(); ++k) {
    const double spacings = steps_m[k] / local_spacing_m(steps_m, k);
    places.push_back(places.back() + std::max(1, static_cast<int>(std::lround(spacings))));
  }
  return places;
}

/// Slot coordinate of a point along a chain: fractional between two trees, extrapolated at the
/// ends; none if the chain is not beside the point.
std::optional<double> place_beside(const Vector2d& p, const Vector2d& along,
                                   const std::vector<Vector2d>& p_map, const RowChain& chain,
                                   const std::vector<int>& places) {
  std::vector<double> ahead_m;
  for (const std::int32_t i : chain) {
    ahead_m.push_back(along.dot(p_map[static_cast<std::size_t>(i)] - p));
  }
  if (chain.size() < 2) return std::nullopt;
  // First tree at or ahead of the point; the ends are extrapolated by a few slots at most.
  std::size_t k = 1;
  while (k + 1 < chain.size() && ahead_m[k] < 0.0) ++k;
  const double step_m = ahead_m[k] - ahead_m[k - 1];
  if (step_m <= 0.0) return std::nullopt;
  const double fraction = -ahead_m[k - 1] / step_m;
  const double place = places[k - 1] + fraction * (places[k] - places[k - 1]);
  if (place < -4.0 || place > places.back() + 1.0) return std::nullopt;
  return place;
}

/// Direction of a chain at its i-th tree: the chord between the neighbours.
Vector2d tangent(const std::vector<Vector2d>& p_map, const RowChain& chain, std::size_t i) {
  const std::size_t before = i == 0 ? 0 : i - 1;
  const std::size_t after = std::min(i + 1, chain.size() - 1);
  return (p_map[static_cast<std::size_t>(chain[after])] -
          p_map[static_cast<std::size_t>(chain[before])])
      .normalized();
}

/// Number of slots by which chain r starts later than chain q; none if they are not beside each
/// other.
std::optional<double> later_start(const std::vector<Vector2d>& p_map, const RowChain& q,
                                  const std::vector<int>& places_q, const RowChain& r,
                                  const std::vector<int>& places_r) {
  std::vector<double> offsets;
  for (std::size_t i = 0; i < std::min(kNumCompared, r.size()); ++i) {
    const auto place = place_beside(p_map[static_cast<std::size_t>(r[i])], tangent(p_map, r, i),
                                    p_map, q, places_q);
    if (place) offsets.push_back(*place - places_r[i]);
  }
  if (offsets.empty()) return std::nullopt;
  return geometry::median(offsets);
}

/// A headland: start of the rows as a linear function of the row index.
struct Headland {
  double start = 0.0;  ///< at row `row`
  double slope = 0.0;  ///< slots per row
  int row = 0;

  double at(int r) const { return start + slope * (r - row); }
};

/// Number of empty slots before a row that starts at `start`.
int places_late(double start, const Headland& line, int r) {
  return std::max(0, static_cast<int>(std::lround(start - line.at(r))));
}

/// Negative log likelihood of the starts of rows first..last if planted along the line: a first
/// tree is missing with probability 0.1, starts scatter by a fifth of a slot, and most headlands
/// are perpendicular to the rows.
double cost_of(const Headland& line, const std::vector<double>& starts, int first, int last) {
  constexpr double kCostMissing = 2.3, kCostMax = 7.0, kScatter = 0.2, kCostSlope = 6.0;
  double cost = std::abs(line.slope) > 0.05 ? kCostSlope : 0.0;
  for (int r = first; r <= last; ++r) {
    const double start = starts[static_cast<std::size_t>(r)];
    const int late = places_late(start, line, r);
    const double off = (start - line.at(r) - late) / kScatter;
    cost += std::min(kCostMax, kCostMissing * late + 0.5 * off * off);
  }
  return cost;
}

/// Number of empty slots at the start of a row, estimated from the rows around it.
int num_empty_before(const std::vector<double>& starts, int r) {
  const int first = std::max(0, r - kRowsAround);
  const int last = std::min(static_cast<int>(starts.size()) - 1, r + kRowsAround);
  const auto start = [&](int k) { return starts[static_cast<std::size_t>(k)]; };
  Headland best{start(r), 0.0, r};
  double least = cost_of(best, starts, first, last);
  for (int a = first; a <= last; ++a) {
    for (int b = a; b <= last; ++b) {  // a == b: perpendicular to the rows
      const Headland line{start(a), a == b ? 0.0 : (start(b) - start(a)) / (b - a), a};
      const double cost = cost_of(line, starts, first, last);
      if (cost < least) {
        least = cost;
        best = line;
      }
    }
  }
  return places_late(start(r), best, r);
}

}  // namespace

// Gaps only make steps longer, so a step from the lower third is single unless two thirds of the
// slots are empty.
double single_step_m(std::vector<double> steps_m) {
  std::sort(steps_m.begin(), steps_m.end());
  const double typical_m = steps_m[steps_m.size() * 3 / 10];
  std::vector<double> single;
  for (const double step_m : steps_m) {
    if (step_m < 1.45 * typical_m) single.push_back(step_m);
  }
  return geometry::median(single);
}

std::vector<std::vector<int>> slot_indices(const std::vector<Vector2d>& p_map,
                                           const std::vector<RowChain>& chains) {
  std::vector<std::vector<int>> positions;
  for (const RowChain& chain : chains) positions.push_back(places_within(p_map, chain));

  // Slot coordinate at which each row starts; rows of a group share one scale.
  std::vector<double> starts(chains.size(), 0.0);
  std::vector<int> group(chains.size(), 0);
  for (std::size_t r = 1; r < chains.size(); ++r) {
    const auto later = later_start(p_map, chains[r - 1], positions[r - 1], chains[r], positions[r]);
    group[r] = group[r - 1] + (later ? 0 : 1);
    starts[r] = later ? starts[r - 1] + *later : 0.0;
  }
  std::vector<int> shifts(chains.size(), 0);
  for (std::size_t begin = 0; begin < chains.size();) {
    std::size_t end = begin;
    while (end < chains.size() && group[end] == group[begin]) ++end;
    const std::vector<double> together(starts.begin() + static_cast<std::ptrdiff_t>(begin),
                                       starts.begin() + static_cast<std::ptrdiff_t>(end));
    for (std::size_t r = begin; r < end; ++r) {
      shifts[r] = num_empty_before(together, static_cast<int>(r - begin));
    }
    begin = end;
  }
  for (std::size_t r = 0; r < chains.size(); ++r) {
    for (int& position : positions[r]) position += shifts[r];
  }
  return positions;
}

double slot_spacing_m(const std::vector<Vector2d>& p_map, const RowChain& chain,
                      const std::vector<int>& positions) {
  std::vector<double> spacings_m;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const double step_m =
        (p_map[static_cast<std::size_t>(chain[i])] - p_map[static_cast<std::size_t>(chain[i - 1])])
            .norm();
    spacings_m.push_back(step_m / (positions[i] - positions[i - 1]));
  }
  return spacings_m.empty() ? 0.0 : geometry::median(spacings_m);
}

}  // namespace orchard::mapping
