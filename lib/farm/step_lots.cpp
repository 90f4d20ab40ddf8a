// SPDX-License-Identifier: BSD-3-Clause
#include "farm/step_lots.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace orchard::farm {
namespace {

constexpr double kStart_s = 0.3;  ///< physical: a job costs the engine so much, with its submission
/// derived: 10 kStart_s, so that the engine takes at most a tenth of the processors.
constexpr double kLeastLot_s = 3.0;
/// derived: Of more lots for each of the jobs that run at a time none is needed: at the end the
/// last one leaves the others idle for an eighth of the time at most. Holds whatever the expected
/// times are worth; before the first run they may be many times too long.
constexpr double kLotsPerJob = 8.0;

/// Steps that must be in one lot.
struct Chain {
  std::vector<const FarmTask*> tasks;
  double time_s = 0.0;
};

/// Puts chains into lots of at least the time for which w/n + n kStart_s, the end of n lots of the
/// work w on n cores, is least.
std::vector<Lot> packed(const std::vector<Chain>& chains, const StepCosts& costs, int num_jobs) {
  double work_s = 0.0;
  for (const Chain& chain : chains) work_s += chain.time_s;
  const double share_s = num_jobs > 0 ? work_s / (kLotsPerJob * num_jobs) : 0.0;
  const double lot_s = std::max({kLeastLot_s, std::sqrt(work_s * kStart_s), share_s});
  std::vector<Lot> lots;
  for (const Chain& chain : chains) {
    if (lots.empty() || lots.back().time_s >= lot_s) lots.emplace_back();
    Lot& lot = lots.back();
    for (const FarmTask* task : chain.tasks) {
      lot.steps.push_back(task->name);
      lot.memory_mb = std::max(lot.memory_mb, expected_memory_mb(*task, costs));
    }
    lot.time_s += chain.time_s;
  }
  for (Lot& lot : lots) {
    std::string text;
    for (const std::string& step : lot.steps) text += step + "\n";
    lot.name = "lot-" + sha256_hex(text).substr(0, kNameDigits);
  }
  return lots;
}

const CostFit& cost_of(const FarmTask& task, const StepCosts& costs) {
  const auto own = costs.find(task.kind);
  return own != costs.end() ? own->second : costs.at(TaskKind::kMap);
}

}  // namespace

double log_mb(const FarmTask& task) {
  constexpr double kBytesPerMb = 1e6;
  double num_bytes = 0.0;
  for (const Drive& drive : task.drives) {
    num_bytes += static_cast<double>(drive.num_bytes);
    if (task.kind == TaskKind::kMap) break;  // the others are the same log
  }
  return num_bytes / kBytesPerMb;
}

double expected_time_s(const FarmTask& task, const StepCosts& costs) {
  return cost_of(task, costs).time_s.of(log_mb(task));
}

double expected_memory_mb(const FarmTask& task, const StepCosts& costs) {
  return cost_of(task, costs).memory_mb.of(log_mb(task));
}

Lots lots_of(const std::vector<FarmTask>& tasks, const StepCosts& costs,
             const std::function<bool(const FarmTask&)>& is_open, int num_jobs) {
  std::vector<Chain> maps, blocks;
  // Blocks that begin with the same dates share these, and therefore a chain.
  std::map<std::string, std::size_t> block_of;
  for (const FarmTask& task : tasks) {
    Chain* chain = nullptr;
    if (task.kind == TaskKind::kMap) {
      if (is_open(task)) chain = &maps.emplace_back();
    } else {
      const bool is_first = task.kind == TaskKind::kDate && task.earlier.empty();
      const std::string& before = is_first               ? task.name
                                  : task.earlier.empty() ? task.needs.front()
                                                         : task.earlier.front();
      const std::size_t block = block_of.try_emplace(before, blocks.size()).first->second;
      block_of[task.name] = block;
      if (block == blocks.size()) blocks.emplace_back();
      if (is_open(task)) chain = &blocks[block];
    }
    if (!chain) continue;
    chain->tasks.push_back(&task);
    chain->time_s += expected_time_s(task, costs);
  }
  blocks.erase(std::remove_if(blocks.begin(), blocks.end(),
                              [](const Chain& chain) { return chain.tasks.empty(); }),
               blocks.end());
  return {packed(maps, costs, num_jobs), packed(blocks, costs, num_jobs)};
}

}  // namespace orchard::farm
