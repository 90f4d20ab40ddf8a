// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/id_keeping.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace orchard::mapping {

std::vector<std::int32_t> keep_indices(
    const std::function<std::vector<std::int32_t>(std::int32_t now)>& then_of, std::int32_t num_now,
    std::int32_t first_unused) {
  std::vector<char> is_observed(static_cast<std::size_t>(num_now), 0);
  std::vector<std::tuple<std::int64_t, std::int32_t, std::int32_t>> votes;  // -count, then, now
  for (std::int32_t i = 0; i < num_now; ++i) {
    std::vector<std::int32_t> thens = then_of(i);
    is_observed[static_cast<std::size_t>(i)] = thens.empty() ? 0 : 1;
    std::sort(thens.begin(), thens.end());
    for (std::size_t begin = 0; begin < thens.size();) {
      std::size_t end = begin;
      while (end < thens.size() && thens[end] == thens[begin]) ++end;
      if (thens[begin] >= 0) {
        votes.emplace_back(-static_cast<std::int64_t>(end - begin), thens[begin], i);
      }
      begin = end;
    }
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
