// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bus/node/node.hpp"
#include "detection/consistency_monitor.hpp"
#include "detection/detect.hpp"
#include "detection/rig.hpp"
#include "detection/scan_image_pairer.hpp"
#include "detector/judged_pair.hpp"
#include "io/config/config.hpp"

namespace orchard::procs {

/// The detector's results for one input, computed ahead of its turn.
class PrecomputedDetections : public bus::Precomputation {
 public:
  void compute() override;

  /// The result for a scan without a camera; none for any other input.
  std::optional<detection::DetectResult> alone;
  /// The scan-image pairs completed by the input, in order.
  struct Pair {
    detection::ScanImagePair pair;
    std::optional<double> edge_reach_px;
    JudgedPair judged;

    /// True if this is the pair and the search window that the detector itself arrived at.
    bool is_of(const detection::ScanImagePair& other,
               const std::optional<double>& other_reach_px) const;
  };
  std::vector<Pair> pairs;

 private:
  friend class DetectionPrecomputer;
  const detection::Rig* rig_ = nullptr;
  const laser::Scan* scan_alone_ = nullptr;
};

/// Predicts the detector's work from the inputs alone: the pairing of scans with pictures and
/// motions depends on nothing else, and neither do the results.
class DetectionPrecomputer {
 public:
  /// Both rigs must outlive this object and its results; `rear_rig` may be null.
  DetectionPrecomputer(const io::Config& config, const detection::Rig& rig,
                       const detection::Rig* rear_rig, double edge_reach_px);

  /// Takes the inputs in order. Every scan gives a result.
  std::unique_ptr<PrecomputedDetections> precompute(const bus::Message& input);

 private:
  const detection::Rig& rig_;
  const detection::Rig* rear_rig_;
  double edge_reach_px_;
  detection::ScanImagePairer pairer_;
  detection::ConsistencyMonitor monitor_;  ///< only for is_due()
};

/// Makes the pairer of scans and pictures for a configuration.
detection::ScanImagePairer make_pairer(const io::Config& config);

}  // namespace orchard::procs
