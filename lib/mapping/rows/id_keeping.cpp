// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/id_keeping.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

namespace orchard::mapping {

std::vector<std::int32_t> keep_indices(const std::vector<std::int32_t>& then_of,
                                       const std::vector<std::int32_t>& now_of,
                                       std::int32_t num_now, std::int32_t first_unused) {
  std::vector<std::pair<std::int32_t, std::int32_t>> shared;  // then, now: once per observation
  std::vector<char> is_observed(static_cast<std::size_t>(num_now), 0);
  for (std::size_t k = 0; k < now_of.size(); ++k) {
    if (now_of[k] < 0) continue;
    is_observed[static_cast<std::size_t>(now_of[k])] = 1;
    if (then_of[k] >= 0) shared.emplace_back(then_of[k], now_of[k]);
  }
  std::sort(shared.begin(), shared.end());

  std::vector<std::tuple<std::int64_t, std::int32_t, std::int32_t>> votes;  // -count, then, now
  for (std::size_t begin = 0; begin < shared.size();) {
    std::size_t end = begin;
    while (end < shared.size() && shared[end] == shared[begin]) ++end;
    votes.emplace_back(-static_cast<std::int64_t>(end - begin), shared[begin].first,
                       shared[begin].second);
    begin = end;
  }
  std::sort(votes.begin(), votes.end());

  std::vector<std::int32_t> kept(static_cast<std::size_t>(num_now), -1);
  std::vector<char> is_taken(static_cast<std::size_t>(first_unused), 0);
  for (const auto& [count, then, now] : votes) {
    std::int32_t& index = kept[static_cast<std::size_t>(now)];
    char& taken = is_taken[static_cast<std::size_t>(then)];
    if (index >= 0 || taken != 0) continue;
    index = then;
    taken = 1;
  }
  for (std::size_t now = 0; now < kept.size(); ++now) {
    if (kept[now] < 0 && is_observed[now] != 0) kept[now] = first_unused++;
  }
  return kept;
}

}  // namespace orchard::mapping
