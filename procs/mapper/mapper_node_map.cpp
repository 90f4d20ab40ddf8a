// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>
#include <vector>

#include "mapper/mapper_node.hpp"
#include "mapping/extent/long_objects.hpp"
#include "mapping/extent/stem_scatter.hpp"
#include "mapping/rows/hedge_rows.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::procs {
namespace {

/// Removes the landmarks with the ids in `ids`, which are in ascending order; returns their number.
std::size_t drop(const std::vector<std::int32_t>& ids, std::vector<mapping::Landmark>& landmarks) {
  const std::size_t num_before = landmarks.size();
  const auto is_dropped = [&](const mapping::Landmark& l) {
    return std::binary_search(ids.begin(), ids.end(), l.id);
  };
  landmarks.erase(std::remove_if(landmarks.begin(), landmarks.end(), is_dropped), landmarks.end());
  return num_before - landmarks.size();
}

}  // namespace

/// Joins long objects. Trees of rows, stems as sharp as theirs, and trees classified with a camera
/// stay separate landmarks; without a camera, parts of a hedge may be classified as trunks.
void MapperNode::join_long(std::vector<mapping::Landmark>& landmarks) const {
  const mapping::StemScatterTest stems(landmarks);
  const auto is_separate = [&](const mapping::Landmark& l) {
    const bool seen_as_tree = has_camera_ && l.label == detection::Label::kTree;
    return l.row > 0 || seen_as_tree || stems.contains(l);
  };
  landmarks = mapping::join_long_objects(std::move(landmarks), object_width_max_m_,
                                         mapper_.seen_passage(), mapper_.seen_free(), is_separate);
}

/// Landmarks with enough observations that exist by the evidence of all scans of the drive.
std::vector<mapping::Landmark> MapperNode::standing_landmarks() const {
  std::vector<mapping::Landmark> all = landmarks();
  drop(mapper_.spurious_ids(), all);
  return all;
}

/// Removes legs of people from landmarks with row numbers; returns their number.
std::size_t MapperNode::drop_legs(std::vector<mapping::Landmark>& landmarks) const {
  return drop(mapper_.leg_ids(landmarks, has_camera_), landmarks);
}

/// Finds rows, numbers the landmarks, removes legs and joins long objects. Parts of hedges that
/// stand in line are found to be no rows only when the hedge is joined, and the rows are found
/// again without them.
MapperNode::Numbered MapperNode::numbered(const std::vector<mapping::Landmark>& standing) const {
  std::vector<std::int32_t> in_hedges;
  while (true) {
    Numbered map{standing, {}, 0};
    if (config_.rows.enabled) {
      std::vector<mapping::Landmark> others = standing;
      drop(in_hedges, others);
      map.rows = mapping::find_rows(others, config_.rows);
      mapping::number_landmarks(map.rows, map.landmarks);
    }
    const std::vector<mapping::Landmark> separate = map.landmarks;
    map.num_legs = drop_legs(map.landmarks);
    join_long(map.landmarks);
    if (has_camera_) return map;
    const std::vector<std::int32_t> found = mapping::trees_of_hedge_rows(separate, map.landmarks);
    if (found.empty()) return map;
    in_hedges.insert(in_hedges.end(), found.begin(), found.end());
    std::sort(in_hedges.begin(), in_hedges.end());
  }
}

std::vector<mapping::Landmark> MapperNode::numbered_landmarks() const {
  return numbered(standing_landmarks()).landmarks;
}

io::MapFolderContent MapperNode::content(const io::MapSummary& summary) const {
  const std::size_t num_all = landmarks().size();
  const std::vector<mapping::Landmark> standing = standing_landmarks();
  Numbered map = numbered(standing);
  io::MapFolderContent content{std::move(map.landmarks), track_.poses(), summary, {}};
  content.rows = std::move(map.rows);
  if (standing.size() < num_all) {
    content.summary.counts.emplace_back("strays_left_out", num_all - standing.size());
  }
  if (map.num_legs > 0) content.summary.counts.emplace_back("legs_left_out", map.num_legs);
  content.photographs = album_.photographs([this](std::int64_t utime) { return track_.at(utime); });
  content.album_bytes_max = album_.max_bytes();
  content.seen_free = mapper_.seen_free();
  content.georeference = georeference();
  content.degraded = degradation_.intervals();
  content.tree_scatter_m = mapper_.tree_scatter_m();
  return content;
}

}  // namespace orchard::procs
