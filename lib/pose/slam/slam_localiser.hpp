// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pose/filter/gnss_positions.hpp"
#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"
#include "pose/scan_matching/scan_motion.hpp"
#include "pose/slam/trunk_slam.hpp"

namespace orchard::pose {

/// Localiser of pose.mode slam: graph SLAM with trunks, without a prior map, and without fixes
/// unless use_fixes or use_gnss of pose.slam is set. The motion between scans comes from the
/// wheels, or from scan matching with `motion: scans`.
class SlamLocaliser : public Localiser {
 public:
  explicit SlamLocaliser(const PoseConfig& config, const laser::LaserConfig& mount = {},
                         const laser::BlindSector& blind = {},
                         std::shared_ptr<ChunkAllocator> memory = nullptr);

  void add(const Measurement& measurement) override;
  std::optional<PoseEstimate> estimate() const override { return slam_.estimate(); }
  std::optional<Trajectory> take_correction() override { return slam_.take_correction(); }
  void finish() override;
  std::string warning() const override;
  std::vector<std::pair<std::string, std::int64_t>> statistics() const override {
    return slam_.statistics();
  }

 private:
  void add(const PoseFix& fix);
  void add(const Gnss& gnss);

  PoseConfig config_;
  laser::LaserConfig mount_;
  laser::BlindSector blind_;
  GnssPositions gnss_;
  std::optional<laser::Scan> scan_;  ///< newest scan
  std::optional<ScanMotion> scan_motion_;
  TrunkSlam slam_;
  std::vector<std::string> at_end_;  ///< what the fixes showed, for warning(); set by finish()
};

}  // namespace orchard::pose
