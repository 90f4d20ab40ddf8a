// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "detection/detect.hpp"
#include "detection/rig.hpp"
#include "detection/scan_image_pairer.hpp"

namespace orchard::procs {

/// What a scan and its picture show.
struct JudgedPair {
  detection::DetectResult result;
  /// Found minus expected column of each object's middle [px], where laser and picture were
  /// compared.
  std::optional<std::vector<double>> edge_offsets_px;
};

/// The detector's work on a scan and its picture. A pure function. With a reach the edges are
/// looked for as widely [px], too: what they say never reaches the detections.
JudgedPair judge_pair(detection::LaserFindings findings, const detection::ScanImagePair& pair,
                      const detection::Rig& rig, std::optional<double> edge_reach_px);

}  // namespace orchard::procs
