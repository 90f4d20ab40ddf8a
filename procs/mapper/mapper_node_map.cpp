// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "mapper/mapper_node.hpp"

namespace orchard::procs {

using mapping::Omission;

mapping::FinishConfig MapperNode::finish_config() const {
  mapping::FinishConfig config;
  config.min_observations = config_.min_observations;
  config.rows = config_.rows;
  config.has_camera = has_camera_;
  config.object_width_max_m = object_width_max_m_;
  return config;
}

const mapping::FinishedMap& MapperNode::finished() const {
  if (!finished_) finished_ = mapping::finish(mapper_, finish_config());
  return *finished_;
}

std::vector<mapping::Landmark> MapperNode::finished_landmarks() const {
  if (finished_) return finished_->landmarks;
  return mapping::finish_without_ways(mapper_, finish_config()).landmarks;
}

io::MapFolderContent MapperNode::content(const io::MapSummary& summary) const {
  const mapping::FinishedMap& map = finished();
  io::MapFolderContent content;
  content.landmarks = map.landmarks;
  content.rows = map.rows;
  content.graph = map.graph;
  content.trajectory = track_.poses();
  content.summary = summary;
  const auto count = [&](const char* name, Omission reason) {
    if (const std::size_t num = map.num_omitted(reason); num > 0) {
      content.summary.counts.emplace_back(name, num);
    }
  };
  count("strays_left_out", Omission::kSpurious);
  content.photographs = album_.photographs([this](std::int64_t utime) { return track_.at(utime); });
  content.album_bytes_max = album_.max_bytes();
  content.georeference = georeference();
  content.degraded = degradation_.intervals();
  content.tree_scatter_m = mapper_.tree_scatter_m();
  return content;
}

}  // namespace orchard::procs
