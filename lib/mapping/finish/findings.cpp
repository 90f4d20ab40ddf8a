// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/findings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <utility>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/compare/landmark_pairing.hpp"

namespace orchard::mapping {
namespace {

/// derived: of fewer landmarks a tenth is no more than three, which may be chance.
constexpr std::size_t kMany = 30;
/// derived: a map of trees has one tree in ten landmarks at least.
constexpr std::size_t kLandmarksPerTree = 10;
/// derived: what one tree in a hundred may be without a doubt about the others.
constexpr std::size_t kTreesPerOverlap = 100;

std::vector<Landmark> trees_of_map(const std::vector<Landmark>& landmarks) {
  std::vector<Landmark> trees;
  std::copy_if(landmarks.begin(), landmarks.end(), std::back_inserter(trees),
               [](const Landmark& l) { return l.label == detection::Label::kTree; });
  return trees;
}

std::size_t num_overlapping(const std::vector<Landmark>& trees) {
  const geometry::IndexedPoints places(landmark_positions(trees));
  double widest_m = 0.0;
  for (const Landmark& l : trees) widest_m = std::max(widest_m, l.width_m);
  std::size_t num = 0;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const auto near = places.within(places[i], widest_m);
    num += std::any_of(near.begin(), near.end(), [&](std::int32_t other) {
      const auto k = static_cast<std::size_t>(other);
      return k != i && (places[k] - places[i]).norm() < 0.5 * (trees[i].width_m + trees[k].width_m);
    });
  }
  return num;
}

std::string centimetres(double length_m) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f cm", 100.0 * length_m);
  return text;
}

Finding overlapping_trees(std::size_t num) {
  return {"overlapping_trees", "",
          std::to_string(num) +
              " trees stand in one another: each is probably one tree mapped twice, because the "
              "path is less sure than it says or a trunk has several stems; look at map.png there, "
              "and drive past these trees once more to close a loop"};
}

Finding few_trees(std::size_t num_trees, const std::vector<Landmark>& landmarks) {
  std::vector<double> widths_m;
  for (const Landmark& l : landmarks) widths_m.push_back(l.width_m);
  return {"few_trees", "detector.width.mean_m",
          std::to_string(num_trees) + " of " + std::to_string(landmarks.size()) +
              " landmarks are trees; half of all are at least " +
              centimetres(geometry::median(std::move(widths_m))) +
              " wide: set detector.width.mean_m and sd_m to the width of your trunks "
              "at the height of the scanner, or lower detector.tree_threshold"};
}

Finding no_rows(std::size_t num_trees) {
  return {"no_rows", "mapper.rows.numbering",
          std::to_string(num_trees) +
              " trees and no row: if they were planted in rows, the path is wrong or "
              "trees are mapped several times; look at map.png and trajectory.csv "
              "(mapper.rows.numbering: none if there are no rows)"};
}

}  // namespace

std::vector<Finding> findings_of(const std::vector<Landmark>& landmarks, bool has_rows) {
  const std::vector<Landmark> trees = trees_of_map(landmarks);
  std::vector<Finding> findings;
  if (trees.size() >= kMany && has_rows &&
      std::none_of(trees.begin(), trees.end(), [](const Landmark& l) { return l.row > 0; })) {
    findings.push_back(no_rows(trees.size()));
  }
  if (landmarks.size() >= kMany && kLandmarksPerTree * trees.size() < landmarks.size()) {
    findings.push_back(few_trees(trees.size(), landmarks));
  }
  if (const std::size_t num = num_overlapping(trees); kTreesPerOverlap * num > trees.size()) {
    findings.push_back(overlapping_trees(num));
  }
  return findings;
}

}  // namespace orchard::mapping
