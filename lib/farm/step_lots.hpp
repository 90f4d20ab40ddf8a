// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "farm/cost_fit.hpp"
#include "farm/farm_tasks.hpp"

namespace orchard::farm {

/// Cost models of the steps; a kind without one costs what a map does.
using StepCosts = std::map<TaskKind, CostFit>;

/// Size of the logs that a step's cost depends on [MB]: of a map its own, else of all its drives.
double log_mb(const FarmTask& task);

/// Expected processor time [s] and peak of memory [MB] of a step.
double expected_time_s(const FarmTask& task, const StepCosts& costs);
double expected_memory_mb(const FarmTask& task, const StepCosts& costs);

/// Steps that one job of the engine makes, one after the other.
struct Lot {
  std::string name;                ///< "lot-" and a digest of its steps
  std::vector<std::string> steps;  ///< names, each after those that it needs
  double time_s = 0.0;             ///< expected, of all steps
  double memory_mb = 0.0;          ///< expected, of the largest step
};

/// Lots of the steps of a farm: of maps, which depend on nothing, and of all else, which depends on
/// maps and on what is in the same lot. Steps that `is_open` refuses are in none.
struct Lots {
  std::vector<Lot> maps, others;
};

/// Packs steps into lots that are long enough for an engine that starts one job at a time: with one
/// core for each lot, starting all takes as long as one of them, which is the soonest end.
/// `num_jobs`: how many run at a time; 0: nobody knows.
Lots lots_of(const std::vector<FarmTask>& tasks, const StepCosts& costs,
             const std::function<bool(const FarmTask&)>& is_open, int num_jobs = 0);

}  // namespace orchard::farm
