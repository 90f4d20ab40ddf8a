// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/hedge_rows.hpp"

#include <algorithm>
#include <map>

#include "mapping/extent/outline.hpp"
#include "mapping/extent/stem_scatter.hpp"

namespace orchard::mapping {
namespace {

using Trees = std::vector<Landmark>;

/// Whether most trees of a row pass a test.
template <class Test>
bool most(const Trees& trees, const Test& test) {
  const auto num = std::count_if(trees.begin(), trees.end(), test);
  return 2 * static_cast<std::size_t>(num) > trees.size();
}

}  // namespace

std::vector<std::int32_t> trees_of_hedge_rows(const std::vector<Landmark>& numbered,
                                              const std::vector<Landmark>& joined) {
  std::vector<Landmark> hedges;
  for (const Landmark& l : joined) {
    if (l.length_m > 0.0) hedges.push_back(l);
  }
  const auto is_in_hedge = [&](const Landmark& tree) {
    return std::any_of(hedges.begin(), hedges.end(), [&](const Landmark& hedge) {
      return is_in_outline(hedge, {tree.x_m, tree.y_m});
    });
  };
  std::map<std::int32_t, Trees> doubtful;
  Trees others;
  if (hedges.empty()) return {};
  for (const Landmark& l : numbered) {
    if (l.row > 0) doubtful[l.row].push_back(l);
  }
  for (auto row = doubtful.begin(); row != doubtful.end();) {
    if (most(row->second, is_in_hedge)) {
      ++row;
      continue;
    }
    others.insert(others.end(), row->second.begin(), row->second.end());
    row = doubtful.erase(row);
  }
  std::vector<std::int32_t> ids;
  if (others.empty()) return ids;
  const StemScatterTest stems(others);
  for (const auto& [number, trees] : doubtful) {
    const auto is_part = [&](const Landmark& tree) {
      return is_in_hedge(tree) && !stems.contains(tree);
    };
    if (!most(trees, is_part)) continue;
    for (const Landmark& tree : trees) ids.push_back(tree.id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace orchard::mapping
