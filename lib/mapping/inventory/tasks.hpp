// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "mapping/compare/map_alignment.hpp"
#include "mapping/compare/map_comparison.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// What `what` of a task that a map gives rise to is; a grower's own has other words.
inline constexpr char kPlantTask[] = "plant";  ///< derived: nothing stands there
inline constexpr char kCheckTask[] = "check";  ///< derived: the tree moved

/// Something for a grower to do at a place.
struct Task {
  std::int32_t number = 0;  ///< kept as long as the task is; 0: drawn by hand, not yet numbered
  bool is_done = false;
  std::string what;
  std::string row;        ///< name; empty: in none
  std::int32_t tree = 0;  ///< position in the row
  std::string why;        ///< "gap", "missing since 2026-05-04", "moved by 0.31 m"
  std::string since;      ///< day of the drive that gave rise to it
  std::string seen;       ///< day of the drive that saw a tree where one was to be planted
  std::string note;       ///< the grower's
  Eigen::Vector2d p_map{0, 0};
};

/// A map, whose gaps give rise to tasks.
struct TaskMap {
  const std::vector<Landmark>& landmarks;
  const std::vector<Row>& rows;
  const RowNames& row_names;
  std::string day;  ///< of its drive
};

/// An earlier map, whose trees that are missing or moved now give rise to tasks.
struct EarlierTrees {
  const std::vector<Landmark>& landmarks;
  const MapComparison& comparison;  ///< of these (a) with the map's (b)
  const MapAlignment& alignment;
  std::string day;
};

struct TaskUpdate {
  std::vector<Task> tasks;  ///< the earlier ones in their order, then the new ones
  int num_new = 0;
  int num_seen = 0;   ///< done now, as a tree stands there
  int num_found = 0;  ///< earlier ones that this map still gives rise to
};

/// Brings tasks up to date. One at a place that still gives rise to it stays as it was ticked; one
/// to plant where a tree stands is done and has its day; where the tree is gone again, a new one
/// begins. What this map neither asks for nor fulfils stays. `earlier`: in the frame of the map.
TaskUpdate update_tasks(std::vector<Task> earlier, const TaskMap& map, const EarlierTrees* before);

}  // namespace orchard::mapping
