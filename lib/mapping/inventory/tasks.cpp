// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/inventory/tasks.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "geometry/point_grid.hpp"
#include "text/number_text.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// derived: half of ComparisonConfig::moved_max_m, beyond which another tree is meant [m].
constexpr double kReach_m = 0.8;

/// The nearest of some places.
struct Nearest {
  std::size_t number = 0;
  double distance_m = std::numeric_limits<double>::infinity();  ///< infinite: none within reach
  bool is_there() const { return distance_m < kReach_m; }
};

class Places {
 public:
  explicit Places(double reach_m) : reach_m_(reach_m) {}

  void add(std::size_t number, const Vector2d& p) {
    grid_.insert(static_cast<std::int32_t>(places_.size()), p);
    places_.emplace_back(number, p);
  }
  Nearest nearest(const Vector2d& p) const {
    Nearest best;
    for (const std::int32_t i : grid_.near(p, reach_m_)) {
      const auto& [number, place] = places_[static_cast<std::size_t>(i)];
      const double distance_m = (place - p).norm();
      if (distance_m < std::min(reach_m_, best.distance_m)) best = {number, distance_m};
    }
    return best;
  }

 private:
  double reach_m_;
  geometry::PointGrid grid_;
  std::vector<std::pair<std::size_t, Vector2d>> places_;
};

/// derived: no neighbour in a row is meant either, so that half of the shortest spacing bounds it.
double reach_m(const std::vector<Row>& rows) {
  double reach_m = kReach_m;
  for (const Row& row : rows) {
    if (row.spacing_m > 0.0) reach_m = std::min(reach_m, 0.5 * row.spacing_m);
  }
  return reach_m;
}

/// What the map and its changes give rise to.
class Wanted {
 public:
  Wanted(const TaskMap& map, double reach_m) : map_(map), planting_(reach_m), checks_(reach_m) {}

  void add_gaps() {
    for (const Row& row : map_.rows) {
      for (const RowSlot& slot : row.places) {
        if (slot.landmark_id != 0) continue;
        add(kPlantTask, row.number, slot.position, slot.p_map, "gap");
      }
    }
  }

  void add_changes(const EarlierTrees& before) {
    for (const MapChange& c : before.comparison.changes) {
      if (c.change == Change::kMissing) {
        const Landmark& l = before.landmarks[static_cast<std::size_t>(c.a)];
        const Vector2d p = geometry::inverse_transform(before.alignment.T_a_b, c.p_a);
        const std::string why = "missing since " + before.day;
        if (const Nearest gap = planting_.nearest(p); gap.is_there()) {
          tasks[gap.number].why = why;
        } else {
          add(kPlantTask, l.row, l.position, p, why);
        }
      } else if (c.change == Change::kMoved) {
        const Landmark& l = map_.landmarks[static_cast<std::size_t>(c.b)];
        add(kCheckTask, l.row, l.position, {l.x_m, l.y_m},
            "moved by " + fixed_text(c.moved_m, 2) + " m");
      }
    }
  }

  /// The task of this kind at a place.
  Nearest find(const std::string& what, const Vector2d& p) const {
    return (what == kPlantTask ? planting_ : checks_).nearest(p);
  }

  std::vector<Task> tasks;

 private:
  void add(const char* what, std::int32_t row, std::int32_t tree, const Vector2d& p,
           const std::string& why) {
    Task task;
    task.what = what;
    if (row != 0) task.row = row_name(map_.row_names, row);
    task.tree = row != 0 ? tree : 0;
    task.why = why;
    task.since = map_.day;
    task.p_map = p;
    (task.what == kPlantTask ? planting_ : checks_).add(tasks.size(), p);
    tasks.push_back(std::move(task));
  }

  const TaskMap& map_;
  Places planting_, checks_;  ///< by number in tasks
};

}  // namespace

TaskUpdate update_tasks(std::vector<Task> earlier, const TaskMap& map, const EarlierTrees* before) {
  const double reach = reach_m(map.rows);
  Wanted wanted(map, reach);
  wanted.add_gaps();
  if (before != nullptr) wanted.add_changes(*before);
  Places trees(reach);
  for (const Landmark& l : map.landmarks) {
    if (l.label == detection::Label::kTree) trees.add(0, {l.x_m, l.y_m});
  }

  TaskUpdate update;
  std::vector<char> is_known(wanted.tasks.size(), 0);
  std::int32_t number = 0;
  for (const Task& task : earlier) number = std::max(number, task.number);
  for (Task& task : earlier) {
    if (task.number == 0) task.number = ++number;
    if (!task.seen.empty() || (task.what != kPlantTask && task.what != kCheckTask)) continue;
    const Nearest same = wanted.find(task.what, task.p_map);
    if (task.what == kPlantTask && trees.nearest(task.p_map).distance_m < same.distance_m) {
      task.is_done = true;
      task.seen = map.day;
      ++update.num_seen;
    } else if (same.is_there() && !is_known[same.number]) {
      const Task& now = wanted.tasks[same.number];
      is_known[same.number] = 1;
      task.row = now.row;
      task.tree = now.tree;
      task.p_map = now.p_map;
      ++update.num_found;
    }
  }
  update.tasks = std::move(earlier);
  for (std::size_t i = 0; i < wanted.tasks.size(); ++i) {
    if (is_known[i]) continue;
    wanted.tasks[i].number = ++number;
    update.tasks.push_back(std::move(wanted.tasks[i]));
    ++update.num_new;
  }
  return update;
}

}  // namespace orchard::mapping
