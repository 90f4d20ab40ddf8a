// SPDX-License-Identifier: BSD-3-Clause
#include "detector/judged_pair.hpp"

#include <utility>

#include "detection/consistency_monitor.hpp"

namespace orchard::procs {

JudgedPair judge_pair(detection::LaserFindings findings, const detection::ScanImagePair& pair,
                      const detection::Rig& rig, std::optional<double> edge_reach_px) {
  JudgedPair judged;
  std::optional<vision::PictureReader> picture;
  if (pair.image) picture.emplace(*pair.image);
  if (picture && edge_reach_px) {
    judged.edge_offsets_px.emplace();
    for (const auto& seen :
         detection::find_candidate_edges(findings, *picture, rig, pair.motion, *edge_reach_px)) {
      judged.edge_offsets_px->push_back(seen.offsets.front().middle_px());
    }
  }
  judged.result = detection::judge_by_camera(std::move(findings), picture ? &*picture : nullptr,
                                             rig, pair.motion);
  return judged;
}

}  // namespace orchard::procs
