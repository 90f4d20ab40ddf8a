// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/lattice_residual.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace orchard::pose {
namespace {

constexpr std::size_t kNumTreesMin = 4;
constexpr std::size_t kNumBases = 24;      // trees whose neighbours define the shifts
constexpr std::size_t kNumMoved = 48;      // trees tested per shift
constexpr std::size_t kNumNeighbours = 3;  // neighbours in the row and in the next one
// Lower quartile of the squared distance of a 2-D Gaussian, in units of the variance: -2 ln(3/4).
constexpr double kQuartile2 = 0.5753641449;
// The shift contains the irregularity of its two trees; a registration averages this out.
constexpr double kMoveVariances = 2.0;

/// Returns the nearest neighbours of a tree, the nearest first.
std::vector<std::size_t> neighbours(const std::vector<Eigen::Vector2d>& trees, std::size_t base) {
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    if (i != base) others.push_back(i);
  }
  const std::size_t num = std::min(kNumNeighbours, others.size());
  std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(num), others.end(),
                    [&](std::size_t a, std::size_t b) {
                      const double a2 = (trees[a] - trees[base]).squaredNorm();
                      const double b2 = (trees[b] - trees[base]).squaredNorm();
                      return a2 < b2 || (a2 == b2 && a < b);
                    });
  others.resize(num);
  return others;
}

}  // namespace

double lattice_residual_sd_m(const std::vector<Eigen::Vector2d>& trees) {
  if (trees.size() < kNumTreesMin) return std::numeric_limits<double>::infinity();
  const std::size_t base_step = 1 + (trees.size() - 1) / kNumBases;
  const std::size_t moved_step = 1 + (trees.size() - 1) / kNumMoved;
  std::vector<double> distances2;
  for (std::size_t base = 0; base < trees.size(); base += base_step) {
    for (const std::size_t neighbour : neighbours(trees, base)) {
      const Eigen::Vector2d move = trees[neighbour] - trees[base];
      for (std::size_t m = 0; m < trees.size(); m += moved_step) {
        if (m == base) continue;  // coincides with its neighbour by construction
        double nearest2 = std::numeric_limits<double>::infinity();
        for (std::size_t t = 0; t < trees.size(); ++t) {
          if (t != m) nearest2 = std::min(nearest2, (trees[t] - trees[m] - move).squaredNorm());
        }
        distances2.push_back(nearest2);
      }
    }
  }
  const auto quartile = distances2.begin() + static_cast<std::ptrdiff_t>(distances2.size() / 4);
  std::nth_element(distances2.begin(), quartile, distances2.end());
  return std::sqrt(*quartile / kQuartile2 / kMoveVariances);
}

}  // namespace orchard::pose
