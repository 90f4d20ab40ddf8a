// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_members.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "geometry/statistics.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/rows/row_slots.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Trees closer than this are in the same slot.
constexpr double kOnePlace_spacings = 0.3;
/// Reward of including a tree of full strength, in squared standard deviations of a step.
constexpr double kStrengthWorth = 4.0;
/// Standard deviation of a step about the spacing, in spacings.
constexpr double kMemberSd_spacings = 0.2;
/// Max number of rejected trees between two accepted ones.
constexpr std::size_t kMaxBetween = 12;

/// Max gap between the end of a chain and the start of its continuation, and max lateral offset
/// [spacings].
constexpr double kMend_spacings = 3.0;
constexpr double kMendBeside_spacings = 0.25;
constexpr std::size_t kFew = 5;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

/// Squared deviation of a step from a whole number of spacings (at least one), in standard
/// deviations.
double step_cost(double spacings) {
  const double whole = std::max(1.0, std::round(spacings));
  const double off = (spacings - whole) / kMemberSd_spacings;
  return off * off / whole;
}

/// Row direction where chain a ends and b begins, and their lateral offset there, robustly from the
/// last few trees of a and the first few of b. None if the directions differ too much.
std::optional<std::pair<Vector2d, double>> across(const std::vector<Vector2d>& p_map,
                                                  const RowDirections& rows, const RowChain& a,
                                                  const RowChain& b) {
  const RowChain last(a.end() - static_cast<std::ptrdiff_t>(std::min(kFew, a.size())), a.end());
  const RowChain first(b.begin(),
                       b.begin() + static_cast<std::ptrdiff_t>(std::min(kFew, b.size())));
  const auto direction_of = [&](const RowChain& few) {
    Vector2d sum(0.0, 0.0);
    for (const std::int32_t i : few) sum += rows.directions[index(i)];
    return sum;
  };
  const Vector2d u_last = direction_of(last), u_first = direction_of(first);
  if (u_last.dot(u_first) < kTurnMax_cos * u_last.norm() * u_first.norm()) return std::nullopt;
  const Vector2d u = (u_last + u_first).normalized();
  const auto beside_m = [&](const RowChain& few) {
    std::vector<double> all_m;
    for (const std::int32_t i : few) {
      all_m.push_back(u.x() * p_map[index(i)].y() - u.y() * p_map[index(i)].x());
    }
    return geometry::median(std::move(all_m));
  };
  return std::make_pair(u, std::abs(beside_m(last) - beside_m(first)));
}

/// Tree spacing along the rows [m] in the presence of clutter. Stems, bushes and hedges only reduce
/// nearest-neighbour distances, so the upper quartile is used.
double spacing_amid_clutter_m(const IndexedPoints& points) {
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (double reach_m = 2.0; reach_m < 200.0; reach_m *= 3.0) {
      const auto near = points.nearest_few(points[i], reach_m, 2);
      if (near.size() < 2) continue;
      const auto other = index(near[0]) == i ? near[1] : near[0];
      distances_m.push_back((points[index(other)] - points[i]).norm());
      break;
    }
  }
  return geometry::quantile(std::move(distances_m), 0.75);
}

/// Insertion point of a tree in a chain: element index and lateral distance.
struct Slot {
  std::size_t before = 0;
  double beside_m = 0.0;
};

}  // namespace

std::vector<double> row_strengths(const std::vector<const Landmark*>& trees) {
  std::vector<double> strengths;
  for (const Landmark* tree : trees) strengths.push_back(tree->probability * tree->roc_mean);
  const double half = 0.5 * geometry::median(strengths);
  for (double& s : strengths) s = half > 0.0 ? s / half : 1.0;
  return strengths;
}

SeedTrees seed_trees(const std::vector<Vector2d>& p_map, const std::vector<double>& strengths) {
  std::vector<Vector2d> strong;
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    if (strengths[i] >= 1.0) strong.push_back(p_map[i]);
  }
  const double reach_m =
      kOnePlace_spacings * spacing_amid_clutter_m(IndexedPoints(std::move(strong)));
  const IndexedPoints all(p_map);
  std::vector<std::size_t> by_strength(p_map.size());
  std::iota(by_strength.begin(), by_strength.end(), std::size_t{0});
  std::stable_sort(by_strength.begin(), by_strength.end(),
                   [&](std::size_t a, std::size_t b) { return strengths[a] > strengths[b]; });
  std::vector<char> stands(p_map.size(), 0);
  SeedTrees result;
  for (const std::size_t i : by_strength) {
    const std::vector<std::int32_t> near = all.within(p_map[i], reach_m);
    if (std::any_of(near.begin(), near.end(), [&](std::int32_t k) { return stands[index(k)]; })) {
      continue;
    }
    stands[i] = 1;
    (strengths[i] >= 1.0 ? result.seeds : result.rest).push_back(i);
  }
  std::sort(result.seeds.begin(), result.seeds.end());
  std::sort(result.rest.begin(), result.rest.end());
  return result;
}

void join_weak_trees(const std::vector<Vector2d>& p_map, const RowDirections& rows,
                     const std::vector<std::size_t>& rest, std::vector<RowChain>& chains) {
  std::vector<Vector2d> members;
  std::vector<std::size_t> chain_of;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (const std::int32_t i : chains[c]) {
      if (chains[c].size() < 3) continue;
      members.push_back(p_map[index(i)]);
      chain_of.push_back(c);
    }
  }
  const IndexedPoints around(std::move(members));
  const auto slot_in = [&](const RowChain& chain, std::size_t tree) {
    const Vector2d& u = rows.directions[tree];
    Slot slot;
    while (slot.before < chain.size() &&
           u.dot(p_map[index(chain[slot.before])] - p_map[tree]) <= 0.0) {
      ++slot.before;
    }
    // The line through the two elements around the tree, or through the last two at an end.
    const std::size_t to = std::clamp<std::size_t>(slot.before, 1, chain.size() - 1);
    const Vector2d &a = p_map[index(chain[to - 1])], &b = p_map[index(chain[to])];
    const Vector2d along = (b - a).normalized(), d = p_map[tree] - a;
    slot.beside_m = std::abs(along.x() * d.y() - along.y() * d.x());
    return slot;
  };
  for (const std::size_t tree : rest) {
    std::size_t best_chain = chains.size();
    Slot best;
    best.beside_m = 0.25 * rows.spacing_m;
    for (const std::int32_t k : around.within(p_map[tree], 1.5 * rows.spacing_m)) {
      const std::size_t c = chain_of[index(k)];
      const Slot slot = slot_in(chains[c], tree);
      if (slot.beside_m >= best.beside_m) continue;
      best = slot;
      best_chain = c;
    }
    if (best_chain == chains.size()) continue;
    RowChain& chain = chains[best_chain];
    chain.insert(chain.begin() + static_cast<std::ptrdiff_t>(best.before),
                 static_cast<std::int32_t>(tree));
  }
}

void bridge_chain_gaps(const std::vector<Vector2d>& p_map, const RowDirections& rows,
                       std::vector<RowChain>& chains) {
  std::vector<Vector2d> starts;
  std::vector<std::size_t> chain_of;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    if (chains[c].size() < 2) continue;
    starts.push_back(p_map[index(chains[c].front())]);
    chain_of.push_back(c);
  }
  const IndexedPoints around(std::move(starts));
  for (std::size_t a = 0; a < chains.size(); ++a) {
    for (bool grown = chains[a].size() >= 2; grown;) {
      grown = false;
      const Vector2d& end = p_map[index(chains[a].back())];
      for (const std::int32_t k : around.within(end, kMend_spacings * rows.spacing_m)) {
        const std::size_t b = chain_of[index(k)];
        if (b == a || chains[b].empty()) continue;
        const auto side = across(p_map, rows, chains[a], chains[b]);
        if (!side || side->second > kMendBeside_spacings * rows.spacing_m) continue;
        chains[a].insert(chains[a].end(), chains[b].begin(), chains[b].end());
        chains[b].clear();
        const Vector2d along = side->first;
        std::stable_sort(chains[a].begin(), chains[a].end(), [&](std::int32_t i, std::int32_t j) {
          return along.dot(p_map[index(i)]) < along.dot(p_map[index(j)]);
        });
        grown = true;
        break;
      }
    }
  }
  chains.erase(std::remove_if(chains.begin(), chains.end(),
                              [](const RowChain& chain) { return chain.empty(); }),
               chains.end());
}

RowChain select_trees_in_slots(const std::vector<Vector2d>& p_map,
                               const std::vector<double>& strengths, const RowChain& chain) {
  std::vector<double> steps_m;  // between trees of full strength
  std::int32_t last = -1;
  for (const std::int32_t i : chain) {
    if (strengths[index(i)] < 1.0) continue;
    if (last >= 0) steps_m.push_back((p_map[index(i)] - p_map[index(last)]).norm());
    last = i;
  }
  if (steps_m.empty()) return chain;
  const double spacing_m = std::max(1e-3, single_step_m(steps_m));

  std::vector<double> worth(chain.size(), 0.0);
  std::vector<std::int32_t> before(chain.size(), -1);
  std::size_t end = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    for (std::size_t j = i > kMaxBetween ? i - kMaxBetween - 1 : 0; j < i; ++j) {
      const double step_m = (p_map[index(chain[i])] - p_map[index(chain[j])]).norm();
      const double through_j = worth[j] - step_cost(step_m / spacing_m);
      if (through_j <= worth[i]) continue;
      worth[i] = through_j;
      before[i] = static_cast<std::int32_t>(j);
    }
    // The cube requires weak trees to stand exactly in a slot.
    worth[i] += kStrengthWorth * std::pow(std::min(1.0, strengths[index(chain[i])]), 3);
    if (worth[i] > worth[end]) end = i;
  }
  RowChain kept;
  for (auto k = static_cast<std::int32_t>(end); k >= 0; k = before[index(k)]) {
    kept.push_back(chain[index(k)]);
  }
  std::reverse(kept.begin(), kept.end());
  return kept;
}

}  // namespace orchard::mapping
