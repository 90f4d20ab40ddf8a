// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "detection/detection.hpp"
#include "simulation/scene/world.hpp"

namespace orchard::evaluation {

/// One observation of one thing by one scan: what truly was there, what was detected, or both.
struct ObservationPair {
  int recording = 0;  ///< which log; observations of one log are not independent
  std::int64_t scan_utime = 0;
  std::size_t detection_index = 0;  ///< in its message; meaningless without a detection
  std::optional<simulation::TrueObservation> truth;
  std::optional<detection::Detection> detection;
  bool has_image = false;  ///< the scan was paired with a picture
  /// Of the detected centre from the true axis [m]; 0 unless both are there.
  double centre_error_m = 0.0;

  bool is_tree() const { return truth && truth->label == detection::Label::kTree; }
  /// From the laser to the surface [m]: the truth's where known.
  double range_m() const { return truth ? truth->range_m : detection->range_m; }
};

/// How true things and detections of a scan are paired.
struct PairingRules {
  double gate_m = 0.3;  ///< farthest a detected centre lies from the true axis
};

/// The pairs of a recording, and what did not fit together.
struct ObservationPairs {
  std::vector<ObservationPair> pairs;
  int num_scans = 0;            ///< with detections and a place in the truth's time
  int num_without_truth = 0;    ///< messages at a time of which the truth holds no scan
  int num_without_message = 0;  ///< scans of the truth that no message answers
};

/// Pairs the truth of each scan with its detections, by utime, then one to one by place (assign()).
///
/// Both are compared in the laser frame: the truth's axis, and the detection's centre, which is
/// brought there from base through the mount that the messages themselves show (surface points are
/// given in both frames). Things that no beam hit take no part. `truth` is in order of utime.
ObservationPairs pair_observations(const std::vector<detection::Detections>& messages,
                                   const std::vector<simulation::TrueObservation>& truth,
                                   int recording, const PairingRules& rules = {});

}  // namespace orchard::evaluation
