// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mapping/finish/map_ways.hpp"
#include "mapping/landmark.hpp"

namespace orchard::view {

/// The map from MAP messages with a revision per change, so that each viewer can be sent the
/// changes since its last request.
class LiveMap {
 public:
  /// Landmarks with fewer than `min_observations` observations are not shown.
  explicit LiveMap(int min_observations) : min_observations_(min_observations) {}

  void take(const mapping::MapTile& tile);

  /// The tiles of this time are the finished map: their numbers hold, even none, and no landmark
  /// has too few observations. Long objects get their extents. Later tiles are again as before.
  void finish(std::int64_t utime, std::vector<mapping::LongObject> long_objects);

  /// Shows exactly these landmarks from now on, regardless of `min_observations`, and removes the
  /// others.
  void show(const std::vector<mapping::Landmark>& landmarks);

  /// Sets rows and positions found so far; tiles contain them only when the map is finished.
  void number(const std::vector<mapping::Landmark>& numbered);

  /// Changes since a revision.
  struct Changes {
    std::vector<mapping::Landmark> landmarks;
    std::vector<std::int32_t> removed_ids;
    std::int64_t revision = 0;  ///< for the next request
  };
  /// Returns the first `num_most` changes after a revision (0: from the beginning).
  Changes changes_since(std::int64_t revision, std::size_t num_most) const;

  /// Incremented with every change.
  std::int64_t revision() const { return revision_; }

  /// All landmarks that are shown, in order of id.
  std::vector<mapping::Landmark> landmarks() const;

 private:
  struct Entry {
    mapping::Landmark landmark;
    bool is_removed = false;
    std::int64_t revision = 0;
  };
  void put(const mapping::Landmark& landmark);
  void remove(std::int32_t id);
  void touch(std::int32_t id, Entry& entry);

  int min_observations_;
  std::optional<std::int64_t> finished_utime_;  ///< of the tiles of the finished map
  std::vector<mapping::LongObject> long_objects_;
  std::map<std::int32_t, Entry> entries_;                ///< by id
  std::map<std::int64_t, std::int32_t> id_of_revision_;  ///< latest revision of each id
  std::int64_t revision_ = 0;
};

/// Formats changes as `"landmarks": columns, "removed": [id]`, without braces.
std::string landmark_changes_json(const LiveMap::Changes& changes);

}  // namespace orchard::view
