// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "detection/detect.hpp"
#include "detection/rig.hpp"
#include "detection/scan_image_pairer.hpp"

namespace orchard::procs {

/// Detections of a scan and its picture.
struct JudgedPair {
  detection::DetectResult result;
  /// Found minus expected column of each object's centre [px]; none when the edges were not
  /// compared.
  std::optional<std::vector<double>> edge_offsets_px;
};

/// Classifies the laser findings of a scan with its picture. A pure function. With `edge_reach_px`,
/// also searches the image edges within this window [px] for the extrinsics monitor, without effect
/// on the detections.
JudgedPair judge_pair(detection::LaserFindings findings, const detection::ScanImagePair& pair,
                      const detection::Rig& rig, std::optional<double> edge_reach_px);

}  // namespace orchard::procs
