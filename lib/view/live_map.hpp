// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::view {

/// The map as MAP tells it, with what changed when, so that each who looks on can be told what is
/// new to them, however long they were away.
class LiveMap {
 public:
  /// Landmarks seen less often than `min_observations` are not shown.
  explicit LiveMap(int min_observations) : min_observations_(min_observations) {}

  void take(const mapping::MapTile& tile);

  /// Exactly these from now on, however often they were seen; the rest is removed.
  void show(const std::vector<mapping::Landmark>& landmarks);

  /// Rows and positions found here, as find_rows() numbers them; tiles bring none until the end.
  void number(const std::vector<mapping::Landmark>& numbered);

  /// What has changed since.
  struct Changes {
    std::vector<mapping::Landmark> landmarks;
    std::vector<std::int32_t> removed_ids;
    std::int64_t revision = 0;  ///< to ask with the next time
  };
  /// The first `num_most` changes after a revision (0: from the beginning).
  Changes changes_since(std::int64_t revision, std::size_t num_most) const;

  /// +1 per change.
  std::int64_t revision() const { return revision_; }

  /// All that are shown, in order of id.
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
  std::map<std::int32_t, Entry> entries_;                ///< by id
  std::map<std::int64_t, std::int32_t> id_of_revision_;  ///< the newest of each id
  std::int64_t revision_ = 0;
};

/// `"landmarks": columns, "removed": [id]`, without braces.
std::string landmark_changes_json(const LiveMap::Changes& changes);

}  // namespace orchard::view
