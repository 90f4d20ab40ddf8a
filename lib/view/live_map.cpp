// SPDX-License-Identifier: BSD-3-Clause
#include "view/live_map.hpp"

#include <set>
#include <utility>

#include "view/map_data.hpp"

namespace orchard::view {

using mapping::Landmark;

namespace {

/// Most tiles of the slow refresh contain no change.
bool is_same(const Landmark& a, const Landmark& b) {
  return a.id == b.id && a.label == b.label && a.num_observations == b.num_observations &&
         a.x_m == b.x_m && a.y_m == b.y_m && a.width_m == b.width_m && a.length_m == b.length_m &&
         a.probability == b.probability && a.row == b.row && a.position == b.position;
}

}  // namespace

void LiveMap::touch(std::int32_t id, Entry& entry) {
  id_of_revision_.erase(entry.revision);
  entry.revision = ++revision_;
  id_of_revision_[entry.revision] = id;
}

void LiveMap::put(const Landmark& landmark) {
  Entry& entry = entries_[landmark.id];
  if (!entry.is_removed && is_same(landmark, entry.landmark)) return;
  entry.landmark = landmark;
  entry.is_removed = false;
  touch(landmark.id, entry);
}

void LiveMap::remove(std::int32_t id) {
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.is_removed) return;
  found->second.is_removed = true;
  touch(id, found->second);
}

void LiveMap::take(const mapping::MapTile& tile) {
  const bool is_finished = tile.utime == finished_utime_;
  for (const Landmark& landmark : tile.landmarks) {
    if (!is_finished && landmark.num_observations < min_observations_) continue;
    Landmark now = landmark;
    if (is_finished) {
      for (const mapping::LongObject& object : long_objects_) {
        if (object.id != now.id) continue;
        now.length_m = object.length_m;
        now.direction_rad = object.direction_rad;
      }
    } else if (now.row == 0) {
      const Landmark& before = entries_[landmark.id].landmark;
      now.row = before.row;
      now.position = before.position;
    }
    put(now);
  }
  for (const std::int32_t id : tile.removed_ids) remove(id);
}

void LiveMap::finish(std::int64_t utime, std::vector<mapping::LongObject> long_objects) {
  finished_utime_ = utime;
  long_objects_ = std::move(long_objects);
}

void LiveMap::show(const std::vector<Landmark>& landmarks) {
  std::set<std::int32_t> ids;
  for (const Landmark& landmark : landmarks) {
    ids.insert(landmark.id);
    put(landmark);
  }
  for (const auto& [id, entry] : entries_) {
    if (ids.count(id) == 0) remove(id);
  }
}

void LiveMap::number(const std::vector<Landmark>& numbered) {
  for (const Landmark& landmark : numbered) {
    const auto found = entries_.find(landmark.id);
    if (found == entries_.end()) continue;
    Landmark& kept = found->second.landmark;
    if (kept.row == landmark.row && kept.position == landmark.position) continue;
    kept.row = landmark.row;
    kept.position = landmark.position;
    touch(landmark.id, found->second);
  }
}

LiveMap::Changes LiveMap::changes_since(std::int64_t revision, std::size_t num_most) const {
  Changes changes;
  changes.revision = revision;
  std::size_t num_left = num_most;
  for (auto at = id_of_revision_.upper_bound(revision); at != id_of_revision_.end() && num_left > 0;
       ++at, --num_left) {
    const Entry& entry = entries_.at(at->second);
    if (entry.is_removed) {
      changes.removed_ids.push_back(at->second);
    } else {
      changes.landmarks.push_back(entry.landmark);
    }
    changes.revision = at->first;
  }
  return changes;
}

std::string landmark_changes_json(const LiveMap::Changes& changes) {
  std::string removed;
  for (const std::int32_t id : changes.removed_ids) {
    removed += (removed.empty() ? "" : ",") + std::to_string(id);
  }
  return "\"landmarks\":" + landmark_columns_json(changes.landmarks, {}) + ",\"removed\":[" +
         removed + "]";
}

std::vector<Landmark> LiveMap::landmarks() const {
  std::vector<Landmark> landmarks;
  for (const auto& [id, entry] : entries_) {
    if (!entry.is_removed) landmarks.push_back(entry.landmark);
  }
  return landmarks;
}

}  // namespace orchard::view
