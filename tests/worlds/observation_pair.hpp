// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "detection/detection.hpp"
#include "worlds/observation_truth.hpp"

namespace orchard::evaluation {

/// One observation of one object in one scan: a true observation, a detection, or both.
struct ObservationPair {
  int recording = 0;  ///< index of the log; observations of one log are not independent
  std::int64_t scan_utime = 0;
  std::size_t detection_index = 0;  ///< index in its message; undefined without a detection
  std::optional<simulation::TrueObservation> truth;
  std::optional<detection::Detection> detection;
  bool has_image = false;  ///< the scan was paired with a picture
  /// Distance of the detected centre from the true axis [m]; 0 unless both exist.
  double centre_error_m = 0.0;

  bool is_tree() const { return truth && truth->label == detection::Label::kTree; }
  /// Range from the laser to the surface [m]; the true one where known.
  double range_m() const { return truth ? truth->range_m : detection->range_m; }
};

/// Rules for pairing true objects with detections of a scan.
struct PairingRules {
  double gate_m = 0.3;  ///< max distance of a detected centre from the true axis
};

/// The pairs of a recording, and numbers of unmatched scans.
struct ObservationPairs {
  std::vector<ObservationPair> pairs;
  int num_scans = 0;            ///< scans with detections and truth
  int num_without_truth = 0;    ///< messages without a true scan of their time
  int num_without_message = 0;  ///< true scans without a message
};

/// Pairs the truth of each scan with its detections: by utime, then one to one by position
/// (assign()).
///
/// Both are compared in the laser frame: the true axis, and the detected centre, transformed from
/// base with the extrinsics estimated from the messages (surface points are given in both frames).
/// Objects without a beam hit take no part. `truth` must be in order of utime.
ObservationPairs pair_observations(const std::vector<detection::Detections>& messages,
                                   const std::vector<simulation::TrueObservation>& truth,
                                   int recording, const PairingRules& rules = {});

}  // namespace orchard::evaluation
