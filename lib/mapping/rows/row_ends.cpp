// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_ends.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Number of trees used to predict the next one: a robust line through five tolerates two outliers.
constexpr std::size_t kLineTrees = 5;
/// The same on either side of a tree between others.
constexpr std::size_t kBesideTrees = 3;
/// Minimum number of trees for the spread about such lines.
constexpr std::size_t kTellingMin = 10;
/// Minimum number of trees for the curvature of a row.
constexpr std::size_t kBendMin = 4;
/// Lateral tolerance with which trees are linked into rows, to either side.
constexpr double kLinked_spacings = 0.3;
/// Prior odds that the last tree of a row belongs to it. High, because cutting off a tree shifts
/// the numbers of its row.
constexpr double kTreeOdds = 300.0;
/// Lower limit of the spread of planted trees [m].
constexpr double kStraightest_m = 0.01;

/// Deviation of a tree of a chain from the line through others.
struct End {
  double beside_m = 0.0;  ///< offset to the left of the line
  double bends_m2 = 0.0;  ///< the same for a row that turns left by 1 rad per metre
  double errs = 0.0;  ///< standard error of beside_m relative to one tree's; larger beyond a gap
};

/// Value at x = 0 of the robust line through (x, y) (Theil-Sen: medians of the slopes and offsets);
/// tolerates two outliers of five.
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

/// Deviation of a tree from the robust line through others of its chain, in their order.
End deviation_of(const std::vector<Vector2d>& p_map, std::int32_t tree, const RowChain& others) {
  const auto at = [&](std::int32_t i) -> const Vector2d& {
    return p_map[static_cast<std::size_t>(i)];
  };
  const auto num = static_cast<double>(others.size());
  const Vector2d along = (at(others.back()) - at(others.front())).normalized();
  std::vector<double> along_m, left_m, turned_m2;
  double mean_m = 0.0, square_m2 = 0.0;
  for (const std::int32_t i : others) {
    const Vector2d d = at(i) - at(tree);
    along_m.push_back(along.dot(d));
    left_m.push_back(along.x() * d.y() - along.y() * d.x());
    turned_m2.push_back(0.5 * geometry::square(along_m.back()));
    mean_m += along_m.back() / num;
  }
  for (const double m : along_m) square_m2 += geometry::square(m - mean_m);
  End end;
  end.beside_m = -at_zero(along_m, left_m);
  end.bends_m2 = -at_zero(along_m, turned_m2);
  end.errs = std::sqrt(1.0 + 1.0 / num + mean_m * mean_m / std::max(1e-6, square_m2));
  return end;
}

/// Deviation of the last tree of a chain from the line through the five before it.
End end_of(const std::vector<Vector2d>& p_map, RowChain::const_iterator last) {
  return deviation_of(p_map, *last, RowChain(last - static_cast<std::ptrdiff_t>(kLineTrees), last));
}

/// Deviations of all trees of a chain that have five trees before them.
std::vector<End> all_ends(const std::vector<Vector2d>& p_map, const RowChain& chain) {
  std::vector<End> all;
  for (std::size_t k = kLineTrees; k < chain.size(); ++k) {
    all.push_back(end_of(p_map, chain.begin() + static_cast<std::ptrdiff_t>(k)));
  }
  return all;
}

/// Curvature of a row [rad/m]: from its own trees, or that of all rows if it is too short.
double curvature(const std::vector<End>& own, double of_all) {
  if (own.size() < kBendMin) return of_all;
  std::vector<double> each;
  for (const End& end : own) each.push_back(end.beside_m / std::max(1e-6, end.bends_m2));
  return geometry::median(std::move(each));
}

/// Distance of a tree from its row's curve [m], scaled to the standard error of one tree.
double off_m(const End& end, double row_curvature) {
  return std::abs(end.beside_m - row_curvature * end.bends_m2) / end.errs;
}

/// Whether trees, in their order, lie on one curve: each within `most_m` of the line through the
/// others.
bool are_in_line(const std::vector<Vector2d>& p_map, const RowChain& trees, double row_curvature,
                 double most_m) {
  for (std::size_t i = 0; i < trees.size(); ++i) {
    RowChain others = trees;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    if (off_m(deviation_of(p_map, trees[i], others), row_curvature) > most_m) return false;
  }
  return true;
}

/// Removes the trees between others that deviate by more than `most_m` from the line of the
/// `kBesideTrees` on either side, if those lie on a line themselves; the slots stay, empty.
void drop_from_middle(const std::vector<Vector2d>& p_map, double row_curvature, double most_m,
                      RowChain& chain) {
  for (std::size_t k = kBesideTrees; k + kBesideTrees < chain.size(); ++k) {
    const auto tree = chain.begin() + static_cast<std::ptrdiff_t>(k);
    const auto beside = static_cast<std::ptrdiff_t>(kBesideTrees);
    RowChain others(tree - beside, tree);
    others.insert(others.end(), tree + 1, tree + 1 + beside);
    if (off_m(deviation_of(p_map, *tree, others), row_curvature) <= most_m) continue;
    if (!are_in_line(p_map, others, row_curvature, most_m)) continue;
    chain.erase(tree);
    --k;
  }
}

}  // namespace

void trim_row_ends(const std::vector<Vector2d>& p_map, double spacing_m,
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
    std::vector<double> curvatures;
    for (const std::vector<End>& own : ends) {
      curvatures.push_back(curvature(own, curvature_of_all));
      for (const End& e : own) offs_m.push_back(off_m(e, curvatures.back()));
    }
    // Exponential distribution: most trees are on the line, some are far off where poses were poor.
    const double mean_m =
        std::max(kStraightest_m, geometry::median(std::move(offs_m)) / std::log(2.0));
    // The limit at which a tree and an object at any position are equally likely.
    const double most_m =
        mean_m * std::log(std::max(1.0, kTreeOdds * kLinked_spacings * spacing_m / mean_m));
    for (std::size_t c = 0; c < chains.size(); ++c) {
      RowChain& chain = chains[c];
      while (chain.size() > kLineTrees &&
             off_m(end_of(p_map, std::prev(chain.end())), curvatures[c]) > most_m) {
        chain.pop_back();
      }
      if (end == 1) drop_from_middle(p_map, curvatures[c], most_m, chain);
      std::reverse(chain.begin(), chain.end());
    }
  }
}

}  // namespace orchard::mapping
