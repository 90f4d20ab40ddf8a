// SPDX-License-Identifier: BSD-3-Clause
#include <utility>
#include <vector>

#include "mapper/mapper_node.hpp"
#include "mapping/extent/long_things.hpp"
#include "mapping/extent/sharp_stems.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::procs {

/// Trees of rows stand there for themselves, and so does a stem that is as sharp as theirs and what
/// a camera called a tree: a laser alone takes a hedge's bits for trunks.
void MapperNode::join_long(std::vector<mapping::Landmark>& landmarks) const {
  const mapping::SharpStems stems(landmarks);
  const auto stands_alone = [&](const mapping::Landmark& l) {
    const bool seen_as_tree = has_camera_ && l.label == detection::Label::kTree;
    return l.row > 0 || seen_as_tree || stems.contains(l);
  };
  landmarks = mapping::join_long_things(std::move(landmarks), widest_m_, mapper_.seen_blocked(),
                                        stands_alone);
}

std::vector<mapping::Landmark> MapperNode::numbered_landmarks() const {
  std::vector<mapping::Landmark> all = landmarks();
  if (config_.rows.enabled) mapping::number_landmarks(mapping::find_rows(all, config_.rows), all);
  join_long(all);
  return all;
}

io::MapFolderContent MapperNode::content(const io::MapSummary& summary) const {
  io::MapFolderContent content{landmarks(), track_.poses(), summary, {}};
  if (config_.rows.enabled) {
    content.rows = mapping::find_rows(content.landmarks, config_.rows);
    mapping::number_landmarks(content.rows, content.landmarks);
  }
  join_long(content.landmarks);
  content.photographs = album_.photographs([this](std::int64_t utime) { return track_.at(utime); });
  content.album_bytes_max = album_.max_bytes();
  content.seen_free = mapper_.seen_free();
  content.georeference = georeference();
  content.degraded = degradation_.stretches();
  content.tree_scatter_m = mapper_.tree_scatter_m();
  return content;
}

}  // namespace orchard::procs
