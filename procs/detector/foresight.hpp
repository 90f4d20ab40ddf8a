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

/// What one input lets the detector send, computed ahead of its turn.
class ForeseenDetections : public bus::Foreseen {
 public:
  void compute() override;

  /// A scan that no camera looks at; none where the input is no such scan.
  std::optional<detection::DetectResult> alone;
  /// The pairs that the input decides, in their order.
  struct Pair {
    detection::ScanImagePair pair;
    std::optional<double> edge_reach_px;
    JudgedPair judged;

    /// Whether it is what the detector itself arrived at.
    bool is_of(const detection::ScanImagePair& other,
               const std::optional<double>& other_reach_px) const;
  };
  std::vector<Pair> pairs;

 private:
  friend class Foresight;
  const detection::Rig* rig_ = nullptr;
  const laser::Scan* scan_alone_ = nullptr;
};

/// Goes ahead of the detector and tells what it will have to look at: which scan has which picture
/// and motion follows from the inputs alone, and what they show from nothing else. Not while models
/// adapt themselves: then each scan is judged by what the scans before it have taught.
class Foresight {
 public:
  /// The rigs of both scanners must outlive it and what it gives; `rear_rig` may be null.
  Foresight(const io::Config& config, const detection::Rig& rig, const detection::Rig* rear_rig,
            double edge_reach_px);

  /// Inputs in order. Gives something for every scan.
  std::unique_ptr<ForeseenDetections> foresee(const bus::Message& input);

 private:
  const detection::Rig& rig_;
  const detection::Rig* rear_rig_;
  double edge_reach_px_;
  detection::ScanImagePairer pairer_;
  detection::ConsistencyMonitor monitor_;  ///< for when it is due only
};

/// What decides which picture belongs to which scan, by the configuration.
detection::ScanImagePairer make_pairer(const io::Config& config);

}  // namespace orchard::procs
