// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_ends.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Trees that tell where the next one stands: a line through them bears two that stand aside.
constexpr std::size_t kLineTrees = 5;
/// So many trees tell how far beside such lines trees stand.
constexpr std::size_t kTellingMin = 10;
/// So many tell how a row curves.
constexpr std::size_t kBendMin = 4;
/// What is taken into a row stands no farther than this to either side, as rows are linked.
constexpr double kLinked_spacings = 0.3;
/// At rows' ends trees are so much more common than other things: one in 300 is none, since to cut
/// off a tree shifts the numbers of its row.
constexpr double kTreeOdds = 300.0;
/// Nobody plants straighter than that [m].
constexpr double kStraightest_m = 0.01;

/// The last of a chain, against the line through the five before it.
struct End {
  double beside_m = 0.0;  ///< how far to the left of the line it stands
  double bends_m2 = 0.0;  ///< how far it would if the row turned left by 1 rad per metre
  double errs = 0.0;  ///< standard errors of the former, of one tree's: beyond a gap it errs more
};

/// What a line through (x, y), of which two may lie off it, says of y at x = 0.
double at_zero(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> slopes, offsets;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t k = i + 1; k < x.size(); ++k) {
      const double dx = x[i] - x[k];
      if (std::abs(dx) > 1e-6) slopes.push_back((y[i] - y[k]) / dx);
    }
  }
  if (slopes.empty()) return y.front();
  const double slope = geometry::midpoint_median(std::move(slopes));
  for (std::size_t i = 0; i < x.size(); ++i) offsets.push_back(y[i] - slope * x[i]);
  return geometry::midpoint_median(std::move(offsets));
}

End end_of(const std::vector<Vector2d>& p_map, RowChain::const_iterator last) {
  const auto at = [&](std::ptrdiff_t back) -> const Vector2d& {
    return p_map[static_cast<std::size_t>(*(last - back))];
  };
  const auto trees = static_cast<std::ptrdiff_t>(kLineTrees);
  const Vector2d along = (at(1) - at(trees)).normalized();
  std::vector<double> along_m, left_m, turned_m2;
  double mean_m = 0.0, square_m2 = 0.0;
  for (std::ptrdiff_t i = 1; i <= trees; ++i) {
    const Vector2d d = at(i) - at(0);
    along_m.push_back(along.dot(d));
    left_m.push_back(along.x() * d.y() - along.y() * d.x());
    turned_m2.push_back(0.5 * geometry::square(along_m.back()));
    mean_m += along_m.back() / static_cast<double>(trees);
  }
  for (const double m : along_m) square_m2 += geometry::square(m - mean_m);
  End end;
  end.beside_m = -at_zero(along_m, left_m);
  end.bends_m2 = -at_zero(along_m, turned_m2);
  end.errs = std::sqrt(1.0 + 1.0 / static_cast<double>(trees) +
                       mean_m * mean_m / std::max(1e-6, square_m2));
  return end;
}

/// Of all trees of a chain that have five before them.
std::vector<End> all_ends(const std::vector<Vector2d>& p_map, const RowChain& chain) {
  std::vector<End> all;
  for (std::size_t k = kLineTrees; k < chain.size(); ++k) {
    all.push_back(end_of(p_map, chain.begin() + static_cast<std::ptrdiff_t>(k)));
  }
  return all;
}

/// How a row curves [rad/m]: by its own trees, or where it is too short to tell, as all do here.
double curvature(const std::vector<End>& own, double of_all) {
  if (own.size() < kBendMin) return of_all;
  std::vector<double> each;
  for (const End& end : own) each.push_back(end.beside_m / std::max(1e-6, end.bends_m2));
  return geometry::median(std::move(each));
}

/// How far beside its row's curve it stands [m], as if that were known as well as the tree.
double off_m(const End& end, double row_curvature) {
  return std::abs(end.beside_m - row_curvature * end.bends_m2) / end.errs;
}

}  // namespace

void cut_ends_beside(const std::vector<Vector2d>& p_map, double spacing_m,
                     std::vector<RowChain>& chains) {
  for (int end = 0; end < 2; ++end) {
    std::vector<std::vector<End>> ends;
    std::vector<End> all;
    for (const RowChain& chain : chains) {
      ends.push_back(all_ends(p_map, chain));
      all.insert(all.end(), ends.back().begin(), ends.back().end());
    }
    if (all.size() < kTellingMin) return;
    const double curvature_of_all = curvature(all, 0.0);
    std::vector<double> offs_m;
    for (const std::vector<End>& own : ends) {
      for (const End& e : own) offs_m.push_back(off_m(e, curvature(own, curvature_of_all)));
    }
    // Most stand where they should, and some, where poses were poor, much farther off: exponential.
    const double mean_m =
        std::max(kStraightest_m, geometry::median(std::move(offs_m)) / std::log(2.0));
    // where a thing that stands anywhere is as likely as a tree
    const double most_m =
        mean_m * std::log(std::max(1.0, kTreeOdds * kLinked_spacings * spacing_m / mean_m));
    for (std::size_t c = 0; c < chains.size(); ++c) {
      RowChain& chain = chains[c];
      const double row_curvature = curvature(ends[c], curvature_of_all);
      while (chain.size() > kLineTrees &&
             off_m(end_of(p_map, std::prev(chain.end())), row_curvature) > most_m) {
        chain.pop_back();
      }
      std::reverse(chain.begin(), chain.end());
    }
  }
}

}  // namespace orchard::mapping
